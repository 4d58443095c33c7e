#include "gi/engines/paths/gathering_points.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

/// More points than this take larger spacings: their rays take 64 MB.
constexpr size_t kMostPoints = 65536;
constexpr float kLargerSpacing = 1.5f;
/// The largest angle between a point's normal and a surface that uses its light, as the paper: 10 degrees.
constexpr float kSpawnTurn = 0.12325684f;  // root of 1 - cos
constexpr size_t kFewestAtOnce = 16, kMostAtOnce = 512, kCandidatesAtOnce = 65536;
/// Candidates of a step, in those that the step before would have needed.
constexpr double kMoreTests = 1.1;
/// Places are narrow where the harmonic mean length of so many rays is below so many radii of the surfel:
/// under the rims of discs that stick out over them, for example, whose light is not that of the places
/// about.
constexpr uint32_t kRaysOfTest = 16;
constexpr float kNarrow = 2;
constexpr size_t kTestsAPiece = 1024, kTracedAPiece = 8, kNormalsAPiece = 16384;

}  // namespace

PointChooser::PointChooser(const Surfaces& surfaces, const Spacing& spacing, uint32_t rays, uint64_t seed)
    : surfaces_(surfaces), rays_(rays), seed_(seed) {
    std::vector<std::pair<uint64_t, Side>> keys(2 * surfaces.discs());
    for (Side side = 0; side < keys.size(); ++side) keys[side] = {mix64(seed, side), side};
    std::ranges::sort(keys);
    for (const auto& [key, side] : keys) order_.push_back(side);
    state_.spacing = spacing;
    state_.parts = surfaces.parts_key();
    start_over();
}

/// Forgets all points, for a new spacing.
void PointChooser::start_over() {
    state_.next = 0;
    state_.points.clear();
    state_.hits.clear();
    grid_.clear();
    tests_a_pass_ = 1;
    find_normals();
}

/// Names a cell as large as the least spacing, for one facing. Opposite facings share it.
uint64_t PointChooser::cell_key(const glm::vec3& position, uint32_t facing) const {
    const glm::ivec3 cell(glm::clamp(glm::floor(position / state_.spacing.least), -1e9f, 1e9f));
    const auto bits = [](int v) { return static_cast<uint64_t>(v) & 0xfffff; };
    return uint64_t{facing} << 60 | bits(cell.z) << 40 | bits(cell.y) << 20 | bits(cell.x);
}

/// Finds the mean normals in cells of the least spacing: the noise of single normals would multiply the
/// points. Surfels are in the order of their nodes here, so their cells stay in a cache; candidates are not.
void PointChooser::find_normals() {
    const std::vector<Surfel>& surfels = surfaces_.tracer().surfels();
    std::unordered_map<uint64_t, glm::vec3> sums;
    for (const Surfel& s : surfels)
        sums[cell_key(s.position, facing_of(s.normal))] += s.normal * std::max(s.area, 1e-12f);
    normals_.resize(surfels.size());
    parallel_ranges(surfels.size(), kNormalsAPiece, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const Surfel& s = surfels[i];
            const uint32_t facing = facing_of(s.normal);
            glm::vec3 sum = s.normal * 1e-12f;
            if (const auto found = sums.find(cell_key(s.position, facing)); found != sums.end())
                sum += found->second;
            if (const auto found = sums.find(cell_key(s.position, facing ^ 1)); found != sums.end())
                sum -= found->second;
            // Two sheets may cancel each other.
            const float length = glm::length(sum);
            glm::vec3 mean = length > 0 ? sum / length : s.normal;
            if (glm::dot(mean, s.normal) < 0) mean = -mean;
            if (glm::dot(mean, s.normal) < 0.5f) mean = s.normal;
            normals_[i] = mean;
        }
    });
}

bool PointChooser::is_covered(const glm::vec3& position, const glm::vec3& normal) const {
    return grid_.any_of(position, [&](uint32_t i) {
        const GatheringPoint& point = state_.points[i];
        return error_of(point, point.reach, kSpawnTurn, position, normal) < 1 && !point.is_hidden(position);
    });
}

bool PointChooser::is_narrow(Side side, const glm::vec3& normal) const {
    const Surfel& s = surfaces_.tracer().surfels()[side / 2];
    return are_shorter(surfaces_, {s.position, normal, s.radius}, seed_, side, kRaysOfTest,
                       kNarrow * s.radius);
}

bool PointChooser::restore(State state) {
    if (state.parts != state_.parts || state.next > order_.size() ||
        state.hits.size() != state.points.size() * rays_ || state.points.size() > kMostPoints ||
        !(state.spacing.least >= state_.spacing.least) || !(state.spacing.most >= state_.spacing.most) ||
        !std::isfinite(state.spacing.most))
        return false;
    for (const GatheringPoint& p : state.points)
        if (p.side >= order_.size() || !(p.reach > 0) || !(p.reach <= state.spacing.most) || !p.is_finite())
            return false;
    const auto is_side = [&](Side side) {
        return side / 2 < surfaces_.surfels().size() && surfaces_.exists(side);
    };
    // Wider than that, places of entry points would be beyond floats.
    const auto is_width = [&](float width) { return width >= 0 && width <= 1e6f * state.spacing.most; };
    for (const RayHit& hit : state.hits)
        if ((!is_side(hit.side) && hit.side != kNone) || !is_width(hit.width)) return false;
    state_.spacing = state.spacing;
    start_over();
    state_ = std::move(state);
    for (uint32_t i = 0; i < state_.points.size(); ++i)
        grid_.add(i, state_.points[i].position, state_.points[i].reach);
    return true;
}

double PointChooser::share() const {
    return order_.empty() ? 1 : static_cast<double>(state_.next) / static_cast<double>(order_.size());
}

bool PointChooser::advance() {
    // Candidates that pass the test against the points before this step are traced together; they are then
    // tested again one after the other.
    const size_t most = std::clamp(state_.points.size() / 4, kFewestAtOnce, kMostAtOnce);
    const size_t first = state_.next;
    // Tests after the last one that passes are made again in the next step.
    const double tests = kMoreTests * tests_a_pass_ * static_cast<double>(most);
    const size_t last = first + std::min({order_.size() - first, kCandidatesAtOnce,
                                          std::max(kMostAtOnce, static_cast<size_t>(tests))});
    std::vector<glm::vec3> normals(last - first);
    std::vector<uint8_t> covered(last - first);
    parallel_ranges(last - first, kTestsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Side side = order_[first + i];
            normals[i] = side % 2 ? -normals_[side / 2] : normals_[side / 2];
            covered[i] = is_covered(surfaces_.tracer().surfels()[side / 2].position, normals[i]) ||
                         is_narrow(side, normals[i]);
        }
    });
    std::vector<size_t> passed;
    for (size_t i = 0; i < covered.size() && passed.size() < most; ++i)
        if (!covered[i]) passed.push_back(i);
    state_.next = passed.size() == most ? first + passed.back() + 1 : last;
    tests_a_pass_ = static_cast<double>(state_.next - first) / static_cast<double>(passed.size() + 1);
    std::vector<RayHit> hits(passed.size() * rays_);
    std::vector<GatheringPoint> points(passed.size());
    parallel_ranges(passed.size(), kTracedAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Side side = order_[first + passed[i]];
            const Surfel& s = surfaces_.tracer().surfels()[side / 2];
            const RayStart start{s.position, normals[passed[i]], s.radius};
            const float length =
                trace_rays(surfaces_, start, seed_, side, std::span(hits).subspan(i * rays_, rays_));
            const float reach = std::clamp(length / 2, state_.spacing.least, state_.spacing.most);
            points[i] = {s.position, start.normal,
                         reach,      s.radius,
                         side,       find_walls(surfaces_.tracer(), start, kPixelReach * reach)};
        }
    });
    for (size_t i = 0; i < passed.size(); ++i) {
        if (is_covered(points[i].position, points[i].normal)) continue;
        if (state_.points.size() == kMostPoints) {
            state_.spacing.least *= kLargerSpacing;
            state_.spacing.most *= kLargerSpacing;
            start_over();
            return true;
        }
        grid_.add(static_cast<uint32_t>(state_.points.size()), points[i].position, points[i].reach);
        state_.points.push_back(points[i]);
        const auto own = hits.begin() + static_cast<std::ptrdiff_t>(i * rays_);
        state_.hits.insert(state_.hits.end(), own, own + rays_);
    }
    return state_.next < order_.size();
}

}  // namespace lucarne::gi::paths
