#include "viewer/commands/edit_report.h"

#include <nlohmann/json.hpp>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/files/file.h"
#include "io/files/json.h"

namespace lucarne::viewer {

void compact_after_update(const octree::EditOptions& edit, octree::EditReport& report) {
    const auto compacted = octree::compact_if_half_unused(edit.cache, edit.temp_folder);
    if (!compacted) {
        log::warn("{}: is updated, but cannot be compacted: {}", edit.cache.string(),
                  compacted.error().line());
        return;
    }
    report.bytes = compacted->bytes;
    if (compacted->done)
        log::info("{}: compacted from {} to {}, as less than half of it was in use", edit.cache.string(),
                  bytes_text(compacted->bytes_before), bytes_text(compacted->bytes));
}

Result<void> write_edit_report(const std::string& path, bool overwrite, const octree::EditReport& report) {
    const nlohmann::json root{
        {"added", report.added},           {"removed", report.removed},
        {"points", report.points},         {"dropped", report.dropped},
        {"kept_nodes", report.kept_nodes}, {"rewritten_points", report.rewritten_points},
        {"nodes", report.nodes},           {"bytes", report.bytes},
        {"already_in", report.already_in}};
    return write_file(path, json_text(root), overwrite);
}

}  // namespace lucarne::viewer
