#include "viewer/commands/edit_report.h"

#include <nlohmann/json.hpp>

#include "io/core/file.h"
#include "io/core/json.h"

namespace lucarne::viewer {

Result<void> write_edit_report(const std::string& path, bool overwrite, const octree::EditReport& report) {
    const nlohmann::json root{
        {"added", report.added},           {"removed", report.removed},
        {"points", report.points},         {"dropped", report.dropped},
        {"kept_nodes", report.kept_nodes}, {"rewritten_points", report.rewritten_points},
        {"nodes", report.nodes},           {"bytes", report.bytes}};
    return write_file(path, json_text(root), overwrite);
}

}  // namespace lucarne::viewer
