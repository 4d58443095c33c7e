#include "viewer/picking/pick.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

constexpr int kReach = 5;               ///< pixels searched around the place
constexpr size_t kMostCandidates = 12;  ///< surfels whose points are read

struct Candidate {
    uint32_t id = 0;
    int distance2 = 0;    ///< pixels^2 from the place to the surfel's nearest pixel
    glm::ivec2 pixel{0};  ///< that pixel
};

glm::dvec3 wide(const glm::vec4& v) {
    return {v.x, v.y, v.z};
}

/// Returns the surfels visible at and around a pixel, the nearest first.
std::vector<Candidate> candidates(const Picture& picture, const glm::ivec2& at) {
    const int width = static_cast<int>(picture.size.width), height = static_cast<int>(picture.size.height);
    std::vector<Candidate> found;
    for (int y = std::max(at.y - kReach, 0); y <= std::min(at.y + kReach, height - 1); ++y)
        for (int x = std::max(at.x - kReach, 0); x <= std::min(at.x + kReach, width - 1); ++x) {
            const uint32_t id =
                picture.ids[static_cast<size_t>(y) * picture.size.width + static_cast<size_t>(x)];
            const int distance2 = (x - at.x) * (x - at.x) + (y - at.y) * (y - at.y);
            if (id != gi::kNoSurfel && distance2 <= kReach * kReach) found.push_back({id, distance2, {x, y}});
        }
    std::ranges::sort(found, {}, [](const Candidate& c) { return std::pair(c.id, c.distance2); });
    // Not std::ranges::unique: clang 14, which builds the fuzzers, cannot compile its result.
    const auto same = [](const Candidate& a, const Candidate& b) { return a.id == b.id; };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    std::ranges::sort(found, {}, [](const Candidate& c) { return std::pair(c.distance2, c.id); });
    if (found.size() > kMostCandidates) found.resize(kMostCandidates);
    return found;
}

/// Returns whether the picture shows the surfel at its point's pixel or a neighbouring pixel.
bool shows(const Picture& picture, uint32_t id, const Projection& point) {
    const int width = static_cast<int>(picture.size.width), height = static_cast<int>(picture.size.height);
    const double most = 1e6;  // prevents integer overflow
    if (std::abs(point.pixel.x) > most || std::abs(point.pixel.y) > most) return false;
    const int x = static_cast<int>(std::floor(point.pixel.x)),
              y = static_cast<int>(std::floor(point.pixel.y));
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
            if (picture.ids[static_cast<size_t>(v) * picture.size.width + static_cast<size_t>(u)] == id)
                return true;
    return false;
}

}  // namespace

std::optional<Projection> project(const Picture& picture, const glm::dvec3& world) {
    const gi::CameraView& view = picture.camera;
    const glm::dvec3 offset = (world - picture.local_origin) * picture.metres_per_unit - wide(view.origin);
    const glm::dvec3 right = wide(view.right), up = wide(view.up);
    const double depth = glm::dot(offset, wide(view.forward));
    if (!(depth > 0)) return std::nullopt;
    const double scale = view.projection == gi::kOrthographic ? 1 : depth;
    const glm::dvec2 ndc(glm::dot(offset, right) / glm::dot(right, right) / scale,
                         -glm::dot(offset, up) / glm::dot(up, up) / scale);
    return Projection{(ndc + 1.0) / 2.0 * glm::dvec2(picture.size.width, picture.size.height), depth};
}

bool hidden(const Picture& picture, const Projection& point, double slack) {
    const double width = picture.size.width, height = picture.size.height;
    if (!(point.pixel.x >= 0 && point.pixel.x < width && point.pixel.y >= 0 && point.pixel.y < height))
        return false;
    const float shown = picture.depth[static_cast<size_t>(point.pixel.y) * picture.size.width +
                                      static_cast<size_t>(point.pixel.x)];
    return shown > 0 && shown < point.depth * (1 - slack);
}

Result<std::optional<PickedPoint>> pick_point(const Picture& picture, const glm::dvec2& place,
                                              NodeCache& cache) {
    if (!(place.x >= 0 && place.x < 1 && place.y >= 0 && place.y < 1) || !picture.points) return std::nullopt;
    const glm::dvec2 at(place.x * picture.size.width, place.y * picture.size.height);
    std::optional<PickedPoint> best, covered;
    double nearest = INFINITY, nearest_covered = INFINITY;
    for (const Candidate& candidate : candidates(picture, glm::ivec2(at))) {
        const auto found = picture.points->find(candidate.id);
        if (!found) continue;
        LUCARNE_ASSIGN(const auto data, cache.node(found->node));
        if (found->index >= data->count) continue;
        const size_t stride = picture.source->part_of(found->node).header.schema.stride;
        ExactPoint point =
            exact_point(*picture.source, found->node, data->records.data() + found->index * stride);
        const auto projected = project(picture, point.position);
        if (!projected) continue;
        if (!shows(picture, candidate.id, *projected)) {
            const glm::dvec3 seen = picture.seen_at(candidate.pixel);
            const double distance = glm::distance(seen, point.position);
            // What covers it may lie before it by no more than the seen place is away from it.
            const double slack = distance * picture.metres_per_unit / projected->depth;
            if (distance < nearest_covered && !hidden(picture, *projected, slack)) {
                nearest_covered = distance;
                covered = PickedPoint{*found, std::move(point)};
            }
            continue;
        }
        const double distance = candidate.distance2 == 0 ? -1 : glm::distance(projected->pixel, at);
        if (distance >= nearest) continue;
        nearest = distance;
        best = PickedPoint{*found, std::move(point)};
        if (nearest < 0) break;  // the pixel at the place itself shows it
    }
    return best ? best : covered;
}

}  // namespace lucarne::viewer
