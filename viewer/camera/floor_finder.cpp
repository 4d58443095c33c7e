#include "viewer/camera/floor_finder.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

// The following are shares of the eye height (1.65 m).
constexpr double kFoot = 0.15;   ///< half the side of the column that is searched: a quarter of a metre
constexpr double kStep = 0.35;   ///< the highest step that the walker climbs
constexpr double kSlab = 0.03;   ///< points within this height belong to one floor
constexpr double kMoved = 0.1;   ///< the eye's move after which the floor is searched again
constexpr size_t kAgreeing = 3;  ///< points that make a floor; fewer may be outliers
constexpr size_t kMostNodes = 64;

/// Returns the heights of points in the column up to `highest`, the highest first. Reads coarse nodes first,
/// so that few nodes suffice.
std::vector<double> heights(const octree::NodeSource& source, const glm::dvec3& at, double half,
                            double highest) {
    std::vector<uint32_t> open = source.roots();
    std::vector<double> found;
    const auto nodes = source.nodes();
    for (size_t next = 0; next < open.size() && next < kMostNodes; ++next) {
        const uint32_t node = open[next];
        const octree::Cube cube = source.cube(node);
        const bool beside = at.x + half < cube.min.x || at.x - half > cube.min.x + cube.size ||
                            at.y + half < cube.min.y || at.y - half > cube.min.y + cube.size;
        if (beside || cube.min.z > highest) continue;
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[node].child(octant); child != octree::kNoNode)
                open.push_back(child);
        const auto data = source.load(node);
        if (!data) continue;  // the node cannot be read; the picture lacks it as well
        const octree::SourcePart part = source.part_of(node);
        const io::Schema& schema = part.header.schema;
        for (uint32_t i = 0; i < data->count; ++i) {
            const glm::dvec3 p =
                io::position_of(schema, &data->records[size_t{i} * schema.stride]) * part.scale;
            if (std::abs(p.x - at.x) <= half && std::abs(p.y - at.y) <= half && p.z <= highest)
                found.push_back(p.z);
        }
    }
    std::ranges::sort(found, std::greater());
    return found;
}

}  // namespace

std::optional<double> floor_below(const octree::NodeSource& source, const glm::dvec3& eye,
                                  double eye_height) {
    const double highest = eye.z - eye_height * (1 - kStep);
    const auto found = heights(source, eye, kFoot * eye_height, highest);
    for (size_t i = 0; i + kAgreeing <= found.size(); ++i)
        if (found[i] - found[i + kAgreeing - 1] <= kSlab * eye_height) return found[i + kAgreeing / 2];
    return std::nullopt;
}

void FloorFinder::look(const std::shared_ptr<const octree::NodeSource>& source, const glm::dvec3& eye,
                       double eye_height) {
    if (!source) return;
    if (source == source_ && asked_ && glm::distance(*asked_, eye) < kMoved * eye_height) return;
    {
        const std::lock_guard lock(shared_->mutex);
        if (shared_->looking) return;
        shared_->looking = true;
    }
    source_ = source;
    asked_ = eye;
    using Floor = Result<std::optional<double>>;
    jobs_.push(
        "looking for the floor",
        [source, eye, eye_height]() -> Floor { return floor_below(*source, eye, eye_height); },
        [shared = shared_](const Floor& floor) {
            const std::lock_guard lock(shared->mutex);
            shared->floor = floor.value_or(std::nullopt);
            shared->looking = false;
        });
}

std::optional<double> FloorFinder::found() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->floor;
}

}  // namespace lucarne::viewer
