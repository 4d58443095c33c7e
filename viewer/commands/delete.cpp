#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/files/file.h"
#include "octree/edit/edit.h"
#include "viewer/commands/build_memory.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/edit_report.h"

namespace lucarne::viewer {
namespace {

struct DeleteOptions {
    octree::EditOptions edit;
    std::vector<double> box;
    std::vector<uint32_t> scan;  ///< none or one
    std::string memory = "2G", json;
};

Result<octree::Selection> selection_of(const DeleteOptions& options) {
    octree::Selection selection;
    if (!options.scan.empty()) selection.scan = options.scan[0];
    if (options.box.empty()) return selection;
    const auto& b = options.box;
    selection.box = octree::Box{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    for (size_t axis = 0; axis < 3; ++axis)
        if (!(b[axis] <= b[axis + 3]))
            return bad_arguments("--box", "the lower corner lies above the upper one",
                                 "give x0,y0,z0,x1,y1,z1");
    return selection;
}

Result<void> erase(const DeleteOptions& given) {
    auto options = given;
    LUCARNE_ASSIGN(options.edit.memory, build_memory(options.memory));
    if (options.box.empty() && options.scan.empty())
        return bad_arguments("delete", "no points are named", "give --box, --scan or both");
    if (!options.json.empty()) LUCARNE_TRY(check_output(options.json, false));
    LUCARNE_ASSIGN(const auto selection, selection_of(options));
    LUCARNE_ASSIGN(auto report, octree::delete_from_cache(selection, options.edit));
    log::info("{}: {} points deleted, {} left; lucarne compact frees their space",
              options.edit.cache.string(), report.removed, report.points);
    compact_after_update(options.edit, report);
    if (options.json.empty()) return {};
    return write_edit_report(options.json, false, report);
}

}  // namespace

void add_delete(CommandLine& line) {
    auto options = std::make_shared<DeleteOptions>();
    Arguments command = line.add("delete", "Delete points from a cache");
    command.add("cache", options->edit.cache, "The cache to change").required().type_name("CACHE");
    command.add("--box", options->box, "Delete points in a box, faces included; in the file's unit")
        .separator(',')
        .values(6)
        .type_name("x0,y0,z0,x1,y1,z1");
    command
        .add("--scan", options->scan, "Delete the points of one input, counted from 0 as in `lucarne info`")
        .values(1)
        .type_name("N");
    command
        .add("--memory", options->memory,
             "Cap on the memory of the process, without the cache's directory (at least 48M)")
        .show_default()
        .type_name("BYTES");
    command.add("--threads", options->edit.threads, "Number of threads; 0: all cores")
        .show_default()
        .type_name("N");
    command.add("--temp", options->edit.temp_folder, "Folder for temporary files (default: the cache's)")
        .type_name("DIR");
    command.add("--json", options->json, "Write what was done as JSON").type_name("FILE");
    command.run([options] { return erase(*options); });
}

}  // namespace lucarne::viewer
