#include "viewer/commands/commands.h"

#include <array>

namespace lucarne::viewer {

void add_compact(CLI::App& app, Command& chosen);
void add_compare(CLI::App& app, Command& chosen);
void add_convert(CLI::App& app, Command& chosen);
void add_delete(CLI::App& app, Command& chosen);
void add_export(CLI::App& app, Command& chosen);
void add_fly(CLI::App& app, Command& chosen);
void add_generate(CLI::App& app, Command& chosen);
void add_info(CLI::App& app, Command& chosen);
void add_measure(CLI::App& app, Command& chosen);
void add_render(CLI::App& app, Command& chosen);
void add_verify(CLI::App& app, Command& chosen);
void add_view(CLI::App& app, Command& chosen);

std::span<const AddCommand> commands() {
    static constexpr std::array<AddCommand, 12> kAll = {add_view,     add_convert, add_render,  add_fly,
                                                        add_generate, add_info,    add_verify,  add_export,
                                                        add_compare,  add_delete,  add_compact, add_measure};
    return kAll;
}

}  // namespace lucarne::viewer
