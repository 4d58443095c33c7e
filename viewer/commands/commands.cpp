#include "viewer/commands/commands.h"

#include <array>
#include <vector>

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

void add_commands(CommandLine& line) {
    struct Group {
        const char* title;
        std::vector<AddCommand> commands;
    };
    const std::array groups = {
        Group{"Look", {add_view, add_render, add_fly, add_prepare}},
        Group{"Scans and caches",
              {add_convert, add_info, add_export, add_delete, add_compact, add_verify, add_voxelize}},
        Group{"Measure and compare", {add_measure, add_compare, add_generate}}};
    for (const Group& group : groups) {
        line.begin_group(group.title);
        for (const AddCommand add : group.commands) add(line);
    }
}

}  // namespace lucarne::viewer
