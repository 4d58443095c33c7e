// Selects the nodes of a cut in one sweep over the quality w = 1 / (projected spacing)^2, the number of
// points per pixel. Sources: Wimmer & Scheiblauer, "Instant Points", 2006 (best-first refinement of a nested
// octree); Schuetz et al., "Real-Time Continuous Level of Detail Rendering of Point Clouds", 2019 (no jumps
// between levels).
//
// At quality w, a node at a distance where a pixel covers `reach` world units needs the density w / reach^2.
// Its parent's points provide 1 / parent_spacing^2, and with all of its own points the density is 1 /
// spacing^2. So the node is absent up to begin = (reach / parent_spacing)^2, whole from end = (reach /
// spacing)^2, and its prefix grows linearly in between, because the density of a prefix is linear in its
// length. Children are never nearer than their parent, so they begin after it is whole. The budget then
// leaves one number to find: the largest w whose points fit.
#include "octree/stream/cut.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <queue>

#include <glm/geometric.hpp>

#include "octree/tree/footprint.h"

namespace lucarne::octree {
namespace {

/// The least ratio of end to begin. It bounds how fast a node fades in: d(prefix share) <= w' / (1 - 1/1.25).
constexpr double kLeastFade = 1.25;
/// Light cuts compete with view cuts for loading as a picture of this many pixels per radian would, which is
/// coarser than a screen.
constexpr double kLightPixelsPerRadian = 256;
/// Radius around the centre of a light cut that is refined evenly, as a share of the scene's extent.
constexpr double kLightCoreShare = 1.0 / 16;
/// The same around a lamp, as a share of the centre's radius: objects a hand's breadth from a lamp matter.
constexpr double kLampCoreShare = 1.0 / 16;

/// Returns how many world units a pixel covers at a cube whose surfels extend `radius` beyond it; empty where
/// the cube is culled.
using Reach = std::function<std::optional<double>(const Cube& cube, double radius)>;

struct Candidate {
    uint32_t node = 0, count = 0;
    double spacing = 0, begin = 0, end = 0;

    uint32_t count_at(double w) const {
        if (w >= end) return count;
        if (w <= begin) return 0;
        return static_cast<uint32_t>(count * ((w - begin) / (end - begin)));
    }

    /// What loading the node adds to the picture per loaded point: the pixels that it covers times the
    /// decrease of the points' spacing there. The spacing is 1/sqrt(begin) without the node and
    /// 1/sqrt(reached) with `used` of its points. Points that raise the density by (reached - begin) cover
    /// used / (reached - begin) pixels.
    float priority_at(double w, uint32_t used) const {
        const double reached = std::min(w, end);
        if (!(begin > 0) || !(reached > begin)) return begin > 0 ? 0.0f : 1e30f;
        const double finer = 1 / std::sqrt(begin) - 1 / std::sqrt(reached);
        const double gain = used / std::max(1.0, static_cast<double>(count)) * finer / (reached - begin);
        return static_cast<float>(std::clamp(gain, 0.0, 1e30));
    }
};

double distance_to(const Cube& cube, const glm::dvec3& point) {
    return glm::length(glm::max(glm::max(cube.min - point, point - (cube.min + cube.size)), glm::dvec3(0.0)));
}

/// Visits candidates in the order in which they become whole.
class Sweep {
 public:
    Sweep(const NodeSource& source, const Reach& reach)
        : source_(source), nodes_(source.nodes()), reach_(reach) {}

    Cut run(uint64_t budget, double w_most) {
        Cut cut;
        if (nodes_.empty() || budget == 0) {
            cut.budget_hit = !nodes_.empty();
            return cut;
        }
        const double w_known = visit(budget, w_most);
        const double w = points_at(w_known) <= budget ? w_known : quality_within(budget, w_known);
        cut.budget_hit = w < w_known;
        cut.visited = visited_;
        for (const Candidate& candidate : candidates_) {
            uint32_t count = candidate.count_at(w);
            if (cut.nodes.empty() && candidate.node == 0)
                count = std::max(count, std::min(candidate.count, 1u));  // a cut is never empty
            if (count == 0 && (candidate.count > 0 || w < candidate.end)) continue;
            cut.nodes.push_back({candidate.node, count, candidate.priority_at(w, count)});
            cut.points += count;
        }
        std::ranges::sort(cut.nodes, {}, &CutNode::node);
        return cut;
    }

 private:
    /// Visits all nodes that begin before `w_most`, or before the quality at which the whole nodes alone
    /// exceed the budget. Returns that quality.
    double visit(uint64_t budget, double w_most) {
        for (const uint32_t root : source_.roots()) add(root, source_.cube(root).size, 0, true);
        uint64_t whole = 0;
        while (!heap_.empty() && heap_.top().first <= w_most) {
            const auto [end, place] = heap_.top();
            heap_.pop();
            const Candidate parent = candidates_[place];
            whole += parent.count;
            if (whole > budget) return end;
            const NodeInfo& info = nodes_[parent.node];
            for (uint32_t octant = 0; octant < 8; ++octant) {
                const uint32_t child = info.child(octant);
                if (child == kNoNode || child <= parent.node || child >= nodes_.size()) continue;
                add(child, parent.spacing, parent.end, false);
            }
        }
        return w_most;
    }

    void add(uint32_t node, double parent_spacing, double parent_end, bool root) {
        ++visited_;
        const NodeInfo& info = nodes_[node];
        Candidate candidate{node, info.count, info.spacing(), 0, 0};
        // A node without a measured spacing (a single point) gets half its parent's, as an octree's level
        // does.
        if (!(candidate.spacing > 0) || !std::isfinite(candidate.spacing))
            candidate.spacing = parent_spacing / 2;
        if (!root) candidate.spacing = std::min(candidate.spacing, parent_spacing);
        const float floor_area = static_cast<float>(candidate.spacing * candidate.spacing);
        const auto reach = reach_(source_.cube(node), surfel_radius(0.0f, floor_area));
        if (!reach || !(*reach > 0) || !std::isfinite(*reach)) return;
        const auto quality = [&](double spacing) { return (*reach / spacing) * (*reach / spacing); };
        if (!root) candidate.begin = std::max(parent_end, quality(parent_spacing));
        candidate.end = std::max(quality(candidate.spacing), candidate.begin * (info.count ? kLeastFade : 1));
        heap_.emplace(candidate.end, static_cast<uint32_t>(candidates_.size()));
        candidates_.push_back(candidate);
    }

    uint64_t points_at(double w) const {
        uint64_t points = 0;
        for (const Candidate& candidate : candidates_) points += candidate.count_at(w);
        return points;
    }

    /// Returns the largest quality up to `w_known` whose points fit. Decides bit by bit, over doubles with 28
    /// bits of mantissa. This grid is the same for every budget, so a larger budget never yields a lower
    /// quality.
    double quality_within(uint64_t budget, double w_known) const {
        uint64_t bits = 0;
        for (int bit = 62; bit >= 24; --bit) {
            const uint64_t tried = bits | uint64_t{1} << bit;
            const double w = std::bit_cast<double>(tried);
            if (w < w_known && points_at(w) <= budget) bits = tried;
        }
        return std::bit_cast<double>(bits);
    }

    using Whole = std::pair<double, uint32_t>;  ///< the quality at which candidates_[second] is whole

    const NodeSource& source_;
    NodeTable nodes_;
    const Reach& reach_;
    std::vector<Candidate> candidates_;
    std::priority_queue<Whole, std::vector<Whole>, std::greater<>> heap_;
    uint64_t visited_ = 0;
};

/// The four sides and the near plane of a view, normals pointing inward.
class Frustum {
 public:
    explicit Frustum(const View& view) : origin_(view.position), near_(view.near_plane) {
        normals_[0] = view.forward;
        normals_[1] = glm::normalize(view.forward * view.tan_half_width + view.right);
        normals_[2] = glm::normalize(view.forward * view.tan_half_width - view.right);
        normals_[3] = glm::normalize(view.forward * view.tan_half_height + view.up);
        normals_[4] = glm::normalize(view.forward * view.tan_half_height - view.up);
    }
    /// False only if no point within `radius` of the cube is inside.
    bool touches(const Cube& cube, double radius) const {
        const double half = cube.size / 2;
        const glm::dvec3 centre = cube.min + half - origin_;
        for (size_t side = 0; side < normals_.size(); ++side) {
            const glm::dvec3& n = normals_[side];
            const double farthest =
                glm::dot(n, centre) + half * glm::dot(glm::abs(n), glm::dvec3(1.0)) + radius;
            if (farthest < (side == 0 ? near_ : 0.0)) return false;
        }
        return true;
    }

 private:
    glm::dvec3 origin_;
    double near_;
    std::array<glm::dvec3, 5> normals_;
};

}  // namespace

Cut view_cut(const NodeSource& source, const View& view, uint64_t budget, double pixel_spacing) {
    const Frustum frustum(view);
    const double pixel = std::min(2 * view.tan_half_width / std::max(view.width, 1u),
                                  2 * view.tan_half_height / std::max(view.height, 1u));  // at distance 1
    const double nearest = std::max(view.near_plane, 1e-9);  // distance of a node around the camera
    const Reach reach = [&](const Cube& cube, double radius) -> std::optional<double> {
        if (!frustum.touches(cube, radius)) return std::nullopt;
        if (view.wanted && !view.wanted(cube)) return std::nullopt;
        return pixel * std::max(nearest, distance_to(cube, view.position));
    };
    return Sweep(source, reach).run(budget, 1 / (pixel_spacing * pixel_spacing));
}

Cut light_view_cut(const NodeSource& source, const View& light, uint64_t budget, double texel_spacing) {
    return view_cut(source, light, budget, texel_spacing);
}

Cut light_cut(const NodeSource& source, const glm::dvec3& centre, uint64_t budget,
              std::span<const glm::dvec3> lamps, double extent) {
    const SourceHeader& header = source.header();
    const double diagonal = extent > 0 ? extent : glm::length(header.max - header.min);
    const double core = kLightCoreShare * std::max(diagonal, header.root.size * 1e-6);
    const Reach reach = [&](const Cube& cube, double) -> std::optional<double> {
        double nearest = std::max(core, distance_to(cube, centre));
        for (const glm::dvec3& lamp : lamps)
            nearest = std::min(nearest, std::max(core * kLampCoreShare, distance_to(cube, lamp)));
        return nearest / kLightPixelsPerRadian;
    };
    return Sweep(source, reach).run(budget, std::numeric_limits<double>::infinity());
}

Cut full_cut(const NodeSource& source) {
    Cut cut;
    const auto nodes = source.nodes();
    cut.visited = nodes.size();
    cut.nodes.reserve(nodes.size());
    for (uint32_t index = 0; index < nodes.size(); ++index) {
        const NodeInfo node = nodes[index];
        cut.nodes.push_back({index, node.count, std::exp2(-static_cast<float>(node.key.level))});
        cut.points += node.count;
    }
    return cut;
}

}  // namespace lucarne::octree
