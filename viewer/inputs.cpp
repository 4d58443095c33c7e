#include "viewer/inputs.h"

#include <fmt/format.h>

#include "octree/open.h"
#include "octree/stream/joined_source.h"
#include "viewer/input.h"

namespace lucarne::viewer {

Result<std::shared_ptr<const octree::NodeSource>> open_inputs(const std::vector<std::string>& paths) {
    if (paths.size() == 1) return open_input(paths.front());
    const auto handles = std::make_shared<HandlePool>(kMostOpenCaches);
    std::vector<std::shared_ptr<const octree::NodeSource>> sources;
    for (const std::string& path : paths) {
        if (octree::is_octree(path)) {
            LUCARNE_ASSIGN(auto octree, octree::open_octree(path, handles));
            sources.push_back(std::move(octree));
        } else {
            LUCARNE_ASSIGN(sources.emplace_back(), open_input(path));
        }
    }
    return octree::join_sources(std::move(sources));
}

std::string inputs_text(const std::vector<std::string>& paths) {
    if (paths.empty()) return {};
    return paths.size() == 1 ? paths.front() : fmt::format("{} and {} more", paths.front(), paths.size() - 1);
}

}  // namespace lucarne::viewer
