#include "gi/engines/paths/interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gi/engines/paths/native/near_points.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// On curved surfaces light changes with the normal, so points whose normals differ by up to 24 degrees count
/// (14 degrees while points share their light, which blurs as well); up to 40 degrees where there are none,
/// as normals of pixels are noisy. The rim of a disc that sticks out through a wall has none like it on its
/// side of the wall: it takes the light of those about it in front of which it lies, turned by up to 102
/// degrees. Roots of 1 - cos.
constexpr float kTurn = 0.29403f, kSharingTurn = 0.17235f, kWideTurn = 0.48369f, kAnyTurn = 1.1f;
/// Pixels with less weight than this in all take the nearest point.
constexpr float kLeastSum = 1e-3f;
constexpr size_t kPlacesAPiece = 256;
/// Points between two looks at whether to stop: to be shared with, and to be tested by some tens of thousands
/// of rays.
constexpr size_t kSharedAtOnce = 16384, kTestedAtOnce = 2048;

}  // namespace

/// Finds the points whose normals turn by less than this. Returns whether their weights suffice.
bool PointFinder::share_within(float turn, const glm::vec3& position, const glm::vec3& normal) {
    shares_.clear();
    bake_.near.visit_lists(position, [&](uint32_t first, uint32_t count) {
        const std::span blocks = std::span(bake_.near_blocks)
                                     .subspan(first / PointCells::kListed,
                                              (count + PointCells::kListed - 1) / PointCells::kListed);
        found_.resize(std::max(found_.size(), blocks.size() * PointCells::kListed));
        const size_t found = native::find_near(blocks, turn, position, normal, found_.data());
        for (size_t i = 0; i < found; ++i) {
            const GatheringPoint& point = bake_.paths.points[found_[i]];
            const float reach = kPixelReach * point.reach;
            const float error2 = squared_error_of(point, reach, turn, position, normal);
            if (error2 >= 1 || point.is_hidden(position)) continue;
            if (turn == kAnyTurn && glm::dot(position - point.position, point.normal) < 0) continue;
            shares_.push_back({found_[i], 1 - std::sqrt(std::max(error2, 0.0f))});
        }
    });
    drop_hidden();
    float weights = 0;
    for (const PointShare& s : shares_) weights += s.share;
    if (!(weights > kLeastSum)) return false;
    for (PointShare& s : shares_) s.share /= weights;
    return true;
}

/// Drops points that walls hide from the one with the largest share. A place has no walls of its own, and
/// those of a point in the open that end near it do not hide all places in the room behind them.
void PointFinder::drop_hidden() {
    const auto most = std::ranges::max_element(shares_, {}, &PointShare::share);
    if (most == shares_.end()) return;
    const std::vector<GatheringPoint>& points = bake_.paths.points;
    const GatheringPoint& own = points[most->point];
    std::erase_if(shares_, [&](const PointShare& s) { return own.is_hidden(points[s.point].position); });
}

bool PointFinder::find_within(float turn, const glm::vec3& position, const glm::vec3& normal) {
    for (const float widest : {turn, kWideTurn, kAnyTurn})
        if (share_within(widest, position, normal)) return true;
    shares_.clear();
    float least = std::numeric_limits<float>::infinity();
    bake_.far.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake_.paths.points[i];
        if (glm::dot(normal, point.normal) <= 0) return;
        const float error2 = squared_error_of(point, point.reach, kWideTurn, position, normal);
        if (error2 >= least) return;
        least = error2;
        shares_.assign(1, {i, 1.0f});
    });
    return false;
}

bool PointFinder::find(const glm::vec3& position, const glm::vec3& normal) {
    return find_within(kTurn, position, normal);
}
bool PointFinder::find_alike(const glm::vec3& position, const glm::vec3& normal) {
    return find_within(kSharingTurn, position, normal);
}

glm::vec3 irradiance_of(std::span<const PointShare> shares, std::span<const glm::vec3> irradiance) {
    glm::vec3 sum(0.0f);
    for (const PointShare& s : shares) sum += s.share * irradiance[s.point];
    return sum;
}

Sharing find_sharing(const PathsBake& bake, size_t places,
                     const std::function<bool(PointFinder&, size_t)>& find) {
    std::vector<std::vector<PointShare>> of_pieces((places + kPlacesAPiece - 1) / kPlacesAPiece);
    Sharing sharing;
    sharing.first.assign(places + 1, 0);
    parallel_ranges(of_pieces.size(), 1, [&](size_t begin, size_t end) {
        PointFinder finder(bake);
        for (size_t piece = begin; piece < end; ++piece)
            for (size_t i = piece * kPlacesAPiece; i < std::min((piece + 1) * kPlacesAPiece, places); ++i) {
                if (!find(finder, i)) continue;
                const std::span<const PointShare> found = finder.shares();
                of_pieces[piece].insert(of_pieces[piece].end(), found.begin(), found.end());
                sharing.first[i + 1] = static_cast<uint32_t>(found.size());
            }
    });
    for (size_t i = 0; i < places; ++i) sharing.first[i + 1] += sharing.first[i];
    sharing.shares.reserve(sharing.first.back());
    for (const auto& piece : of_pieces)
        sharing.shares.insert(sharing.shares.end(), piece.begin(), piece.end());
    return sharing;
}

bool SharingFinder::advance() {
    const std::vector<GatheringPoint>& points = bake_.paths.points;
    const size_t first = sharing_.first.size() - 1, count = std::min(points.size() - first, kSharedAtOnce);
    const Sharing more = find_sharing(bake_, count, [&](PointFinder& finder, size_t i) {
        finder.find_alike(points[first + i].position, points[first + i].normal);
        return true;
    });
    const auto before = static_cast<uint32_t>(sharing_.shares.size());
    for (size_t i = 0; i < count; ++i) sharing_.first.push_back(before + more.first[i + 1]);
    sharing_.shares.insert(sharing_.shares.end(), more.shares.begin(), more.shares.end());
    return first + count < points.size();
}

double HiddenFinder::share() const {
    const size_t points = bake_.paths.points.size();
    return points == 0 ? 1 : static_cast<double>(next_) / static_cast<double>(points);
}

bool HiddenFinder::advance() {
    const std::vector<GatheringPoint>& points = bake_.paths.points;
    const auto above = [&](uint32_t i) {
        return tracing::offset_origin(points[i].position, points[i].normal, points[i].radius);
    };
    const size_t first = next_, last = std::min(points.size(), first + kTestedAtOnce);
    std::vector<std::vector<PointPair>> of_pieces((last - first + kPlacesAPiece - 1) / kPlacesAPiece);
    parallel_ranges(last - first, kPlacesAPiece, [&](size_t begin, size_t end) {
        std::vector<PointPair>& of_piece = of_pieces[begin / kPlacesAPiece];
        for (size_t i = first + begin; i < first + end; ++i)
            for (const PointShare& share : sharing_.of(i)) {
                const auto own = static_cast<uint32_t>(i);
                if (share.point != own && tracer_.occluded(above(own), above(share.point)))
                    of_piece.push_back({own, share.point});
            }
    });
    for (const auto& piece : of_pieces) hidden_.insert(hidden_.end(), piece.begin(), piece.end());
    next_ = last;
    return next_ < points.size();
}

Sharing without(const Sharing& sharing, std::span<const PointPair> hidden) {
    Sharing seen;
    for (uint32_t i = 0; i + 1 < sharing.first.size(); ++i) {
        const size_t begin = seen.shares.size();
        seen.first.push_back(static_cast<uint32_t>(begin));
        size_t own = 0;
        while (own < hidden.size() && hidden[own].first == i) ++own;
        float sum = 0;
        for (const PointShare& share : sharing.of(i)) {
            const auto is_it = [&](const PointPair& pair) { return pair.second == share.point; };
            if (std::ranges::any_of(hidden.first(own), is_it)) continue;
            seen.shares.push_back(share);
            sum += share.share;
        }
        for (size_t k = begin; k < seen.shares.size(); ++k) seen.shares[k].share /= sum;
        hidden = hidden.subspan(own);
    }
    seen.first.push_back(static_cast<uint32_t>(seen.shares.size()));
    return seen;
}

std::vector<glm::vec3> smooth(const PathsBake& bake, std::span<const glm::vec3> irradiance) {
    std::vector<glm::vec3> smoothed(irradiance.size());
    for (size_t i = 0; i < smoothed.size(); ++i) smoothed[i] = irradiance_of(bake.sharing.of(i), irradiance);
    return smoothed;
}

}  // namespace lucarne::gi::paths
