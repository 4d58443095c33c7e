#include "viewer/commands/commands.h"

#include <array>

namespace lucarne::viewer {

void add_compact(CommandLine& line);
void add_compare(CommandLine& line);
void add_convert(CommandLine& line);
void add_delete(CommandLine& line);
void add_export(CommandLine& line);
void add_fly(CommandLine& line);
void add_generate(CommandLine& line);
void add_info(CommandLine& line);
void add_measure(CommandLine& line);
void add_prepare(CommandLine& line);
void add_render(CommandLine& line);
void add_verify(CommandLine& line);
void add_view(CommandLine& line);
void add_voxelize(CommandLine& line);

std::span<const AddCommand> commands() {
    static constexpr std::array<AddCommand, 14> kAll = {
        add_view,   add_convert, add_render, add_fly,     add_generate, add_info,    add_verify,
        add_export, add_compare, add_delete, add_compact, add_measure,  add_prepare, add_voxelize};
    return kAll;
}

}  // namespace lucarne::viewer
