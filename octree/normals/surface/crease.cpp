#include "octree/normals/surface/crease.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "octree/normals/surface/surface_share.h"

namespace lucarne::octree {
namespace {

constexpr size_t kLeastRun = 6;  ///< points of a run
/// A side has at least one of so many points of the patch. That of a reveal that a station saw at a flat
/// angle, beside a dense wall, has hardly more. A plane across the two faces of a thin wall has fewer.
constexpr size_t kLeastPart = 5;
constexpr size_t kLeastSide = 8;  ///< points of each of two planes at a crease
/// Points within this many deviations of a plane belong to it. Where there is no noise, within this share of
/// the spacing.
constexpr float kInliers = 3.0f, kInSpacing = 0.05f;
constexpr float kLeastOffset = 0.1f;  ///< in spacings: a point's cell reaches at least so far to the crease
constexpr double kTurned = 0.91;      ///< largest |n.n'| of two planes at a crease: 24 degrees
constexpr int kRefits = 2;
/// The side of a crease is that much flatter (variance of heights) than the whole. Of noise, too, some part
/// is flatter than the whole, but only by half.
constexpr float kFlatter = 0.3f;
/// A run, or a first refit, that is not flatter than this is not the start of a side. Of the sides that are
/// used in the end, 99 of 100 begin with a flatter run.
constexpr float kFlatRun = 0.5f;
/// Least |n.n'| of a side and the whole window: 60 degrees. Between two sides at right angles it is 45
/// degrees where both have as many points, and more for the side that has fewer.
constexpr float kLeastTurn = 0.5f;
/// Planes through a point and two of so many neighbours are tried, of those around the point and around the
/// nearest point beside a side. The squared sine (30 degrees) of the angle between the two, seen from the
/// point.
constexpr size_t kSeeds = 8, kBesideSeeds = 6;
constexpr float kLeastSpread = 0.25f;
/// Points so near to a plane that is tried lie in it: in spacings, and in deviations of the side beside it.
constexpr float kSeedLimit = 0.15f, kSeedDeviations = 2.0f;
constexpr float kMostLimit = 1.5f;  ///< times that, for the plane through them
constexpr int kNarrowRefits = 3;
constexpr float kMostOff = 0.15f;   ///< height of a point over its own narrow face, in spacings
constexpr size_t kLeastBeside = 5;  ///< points of a plane beside a side
constexpr int kMostPlanes = 3;      ///< beside a side that are looked at
/// Another layer, such as the other face of a board, has a normal that differs by less than 6 degrees, and is
/// so far away, in spacings.
constexpr double kParallel = 0.995, kLayersApart = 1;
/// Of the points around a narrow face, one of so many lies neither on it nor in a plane beside it, at most.
constexpr size_t kScattered = 3;

/// In noise or among leaves, some plane has many points near it, too. A face has so many times as many, and
/// so many more, as a slab of points that fill the ball about the patch evenly: a plane beside a side, a
/// narrow face where the points around have no plane, and one where they may be a noisy plane.
struct Excess {
    float times, more;
};
constexpr Excess kBesideExcess{2.5f, 3};
constexpr Excess kNarrowExcess{2.2f, 3};
constexpr Excess kNoiseExcess{3, 4};

/// The variance of heights over a plane that was fitted to `count` points.
double variance_of(const Plane& plane, size_t count) {
    const double n = static_cast<double>(count);
    return plane.variances[0] * n / (n - 3);
}

float limit_of(const Plane& plane, size_t count, float spacing) {
    return std::max(kInliers * static_cast<float>(std::sqrt(variance_of(plane, count))),
                    kInSpacing * spacing);
}

glm::dvec3 middle_of(const Moments& m) {
    return glm::dvec3(m.sum[0], m.sum[1], m.sum[2]) / static_cast<double>(m.count);
}

bool is_better(const Side& side, const SurfaceFit& whole) {
    const float turn = std::abs(glm::dot(glm::vec3(side.plane.normal), whole.normal));
    return side.deviation < whole.deviation && side.variance < kFlatter * whole.variance && turn > kLeastTurn;
}

/// How often a side's plane is fitted again, to how many points at least, and how far these may be from it.
struct RefitLimits {
    int times;
    size_t least;
    float height;
};
/// Fits a side's plane to all points that lie in it, again and again. Returns nothing if they are too few, or
/// not flat.
struct Refit {
    Moments own;
    Slab slab{};
};
std::optional<Refit> refit(const Patch& patch, const SurfaceFit& whole, float spacing, Moments own,
                           const RefitLimits& limits, Side& side) {
    Refit found{own};
    side.plane = plane_of(own);
    side.count = own.count;
    for (int time = 0; time < limits.times; ++time) {
        found.slab = {glm::vec3(side.plane.normal),
                      static_cast<float>(glm::dot(side.plane.normal, middle_of(found.own))),
                      std::min(limit_of(side.plane, side.count, spacing), limits.height)};
        found.own = moments_of_slab(patch, found.slab, false);
        if (found.own.count < std::max(kLeastSide, limits.least) ||
            patch.count - found.own.count < kLeastSide)
            return std::nullopt;
        side.plane = plane_of(found.own);
        side.count = found.own.count;
        side.variance = static_cast<float>(variance_of(side.plane, side.count));
        if (side.variance > kFlatRun * whole.variance) return std::nullopt;
    }
    side.deviation = deviation_of(side.plane, side.count);
    return found;
}

/// Keeps the points of a patch that do not lie in a slab, without the centre.
void keep_beside(const Patch& patch, const Slab& slab, Patch& rest) {
    rest.make_room(patch.count);
    size_t kept = 0;
    for (size_t i = 0; i < patch.count; ++i) {
        const glm::vec3 p = patch.offset(i);
        if (std::abs(glm::dot(p, slab.normal) - slab.level) <= slab.limit || patch.distance2[i] == 0)
            continue;
        rest.x[kept] = p.x, rest.y[kept] = p.y, rest.z[kept] = p.z;
        rest.distance2[kept++] = patch.distance2[i];
    }
    rest.count = kept;
    rest.pad();
}

/// Directions from a point to those nearest to it, with their squared distances.
struct Seeds {
    struct Seed {
        float distance2;
        glm::vec3 to;
    };
    std::array<Seed, kSeeds> nearest;
    size_t count = 0;

    /// Takes the `most` nearest of a patch; not those at the point itself.
    Seeds(const Patch& patch, const glm::vec3& from, size_t most) {
        for (size_t i = 0; i < patch.count; ++i) {
            const glm::vec3 to = patch.offset(i) - from;
            const float d2 = glm::dot(to, to);
            if (!(d2 > 0) || (count == most && d2 >= nearest[count - 1].distance2)) continue;
            size_t at = count < most ? count++ : count - 1;
            for (; at > 0 && nearest[at - 1].distance2 > d2; --at) nearest[at] = nearest[at - 1];
            nearest[at] = {d2, to};
        }
        for (size_t i = 0; i < count; ++i) nearest[i].to = glm::normalize(nearest[i].to);
    }
};

/// Tries planes through a point and two of its seeds (RANSAC with all pairs). Returns the slab about the one
/// that holds the most points of a patch; nothing if none has `least`. Those that are also in `close`, the
/// nearest, count three times: a plane that cuts a larger face far away is not that of the point.
std::optional<Slab> fullest_slab(const Patch& patch, const Patch* close, const glm::vec3& through,
                                 const Seeds& seeds, float limit, size_t least) {
    std::optional<Slab> best;
    size_t most = 0;
    for (size_t i = 1; i < seeds.count; ++i)
        for (size_t j = 0; j < i; ++j) {
            const glm::vec3 n = glm::cross(seeds.nearest[i].to, seeds.nearest[j].to);
            const float size2 = glm::dot(n, n);
            if (!(size2 > kLeastSpread)) continue;
            const glm::vec3 normal = n / std::sqrt(size2);
            const Slab slab{normal, glm::dot(normal, through), limit};
            const size_t count = count_in_slab(patch, slab);
            const size_t score = count + (close ? 2 * count_in_slab(*close, slab) : 0);
            if (count < least || score <= most) continue;
            most = score;
            best = slab;
        }
    return best;
}

/// A plane through points beside a side.
struct Beside {
    Plane plane;
    Moments points;
    float limit = 0;  ///< of their slab
};

/// Takes the plane nearest to the point out of the points beside a side: of the planes through the nearest of
/// them and two of those around it, the one with the most points. Returns nothing if there are too few.
std::optional<Beside> take_nearest_plane(Patch& rest, float spacing, float limit) {
    if (rest.count < kLeastBeside) return std::nullopt;
    const auto last = rest.distance2.begin() + static_cast<ptrdiff_t>(rest.count);
    const auto nearest = std::min_element(rest.distance2.begin(), last) - rest.distance2.begin();
    const glm::vec3 through = rest.offset(static_cast<size_t>(nearest));
    auto slab = fullest_slab(rest, nullptr, through, Seeds(rest, through, kBesideSeeds), limit, kLeastBeside);
    if (!slab) return std::nullopt;
    Beside found;
    for (int fit = 0; fit < 2; ++fit) {
        found.points = moments_of_slab(rest, *slab, false);
        if (found.points.count < kLeastBeside) return std::nullopt;
        found.plane = plane_of(found.points);
        slab->normal = glm::vec3(found.plane.normal);
        slab->level = static_cast<float>(glm::dot(found.plane.normal, middle_of(found.points)));
        slab->limit =
            std::clamp(limit_of(found.plane, found.points.count, spacing), limit, kMostLimit * limit);
    }
    found.limit = slab->limit;
    keep_beside(rest, *slab, rest);
    return found;
}

/// Returns the crease of a side with another plane; nothing if they do not cross.
std::optional<Crease> crease_with(const Beside& other, const Side& side, const glm::dvec3& middle,
                                  float spacing) {
    const glm::dvec3& n = other.plane.normal;
    const double crossing = glm::dot(n, side.plane.normal);
    if (std::abs(crossing) > kTurned) return std::nullopt;
    const glm::dvec3 there = middle_of(other.points);
    const double offset = glm::dot(n, there);
    // The side's points tell on which side of the other plane it lies; noise may put the point across.
    const bool below = glm::dot(n, middle) < offset, across = below != (0 < offset);
    const float least = kLeastOffset * spacing, limit = limit_of(side.plane, side.count, spacing);
    Crease crease{glm::vec3(n), static_cast<float>(offset)};
    if (std::abs(crease.offset) < (across ? std::max(2 * limit, least) : least))
        crease.offset = below ? least : -least;
    crease.rises = glm::dot(side.plane.normal, there - middle) > 0;
    crease.roughness = static_cast<float>(std::sqrt(variance_of(other.plane, other.points.count)));
    crease.distance = std::abs(crease.offset) / static_cast<float>(std::sqrt(1 - crossing * crossing));
    return crease;
}

/// Squared distance of the farthest point of a patch.
float farthest2(const Patch& patch) {
    const auto last = patch.distance2.begin() + static_cast<ptrdiff_t>(patch.count);
    return *std::max_element(patch.distance2.begin(), last);
}

/// Whether a slab holds more of some points, `of` in number, than if these filled the ball about the patch
/// evenly.
bool stands_out(size_t count, float limit, const Patch& patch, size_t of, const Excess& excess) {
    const float share = 1.5f * limit / std::sqrt(farthest2(patch));
    return static_cast<float>(count) >= excess.times * share * static_cast<float>(of) + excess.more;
}

/// Finds the creases at which a side ends. Returns how many points lie neither on the side nor in a plane
/// beside it; nothing if no plane beside it shows that it is a side.
std::optional<size_t> find_creases(const Patch& patch, const Refit& own, float spacing, Side& side) {
    const glm::dvec3 middle = middle_of(own.own);
    Patch rest;
    keep_beside(patch, own.slab, rest);
    const float seed_limit = std::max(kSeedLimit * spacing, kSeedDeviations * std::sqrt(side.variance));
    for (int plane = 0; plane < kMostPlanes && side.second.distance == 0; ++plane) {
        const size_t left = rest.count;
        const auto other = take_nearest_plane(rest, spacing, seed_limit);
        if (!other) break;
        if (!stands_out(other->points.count, other->limit, patch, left, kBesideExcess)) continue;
        const auto crease = crease_with(*other, side, middle, spacing);
        if (!crease) {
            const glm::vec3 n(other->plane.normal);
            const double apart = glm::dot(other->plane.normal, middle_of(other->points) - middle);
            const glm::vec3 axis(side.plane.normal);
            if (std::abs(glm::dot(n, axis)) > kParallel && std::abs(apart) > kLayersApart * spacing)
                side.layered = apart * glm::dot(n, axis) > 0 ? axis : -axis;
            continue;
        }
        (side.first.distance > 0 ? side.second : side.first) = *crease;
    }
    if (side.first.distance == 0 && side.layered == glm::vec3(0.0f)) {
        const Moments all = moments_of_slab(patch, own.slab, true);
        const auto crease = crease_with({plane_of(all), all, 0}, side, middle, spacing);
        if (!crease) return std::nullopt;
        side.first = *crease;
    }
    if (side.second.distance > 0 && side.second.distance < side.first.distance)
        std::swap(side.first, side.second);
    const float limit = limit_of(side.plane, side.count, spacing);
    const auto level = static_cast<float>(glm::dot(side.plane.normal, middle));
    side.layer = {std::min(0.0f, level - limit), std::max(0.0f, level + limit)};
    return rest.count;
}

}  // namespace

std::optional<Side> fit_side(const Patch& patch, const SurfaceFit& whole, float spacing) {
    const SectorRun run = flattest_run(patch, tangent_frame(whole.normal), kLeastRun);
    if (run.moments.count == 0 || run.misfit > kFlatRun * whole.variance) return std::nullopt;
    Side side;
    const RefitLimits limits{kRefits, patch.count / kLeastPart, std::numeric_limits<float>::infinity()};
    const auto found = refit(patch, whole, spacing, run.moments, limits, side);
    if (!found || !is_better(side, whole)) return std::nullopt;
    // In noise, some plane beside the side crosses it, but not that of all points beside it.
    const Plane all = plane_of(moments_of_slab(patch, found->slab, true));
    if (std::abs(glm::dot(all.normal, side.plane.normal)) > kTurned) return std::nullopt;
    if (!find_creases(patch, *found, spacing, side)) return std::nullopt;
    return side;
}

std::optional<Side> fit_narrow_side(const Patch& nearest, const Patch& patch, const SurfaceFit& whole,
                                    float spacing, bool noisy_plane) {
    const auto best = fullest_slab(patch, &nearest, glm::vec3(0.0f), Seeds(nearest, glm::vec3(0.0f), kSeeds),
                                   kSeedLimit * spacing, kLeastSide);
    if (!best) return std::nullopt;
    Side side;
    const float height = noisy_plane ? std::numeric_limits<float>::infinity() : kMostLimit * best->limit;
    const RefitLimits limits{kNarrowRefits, kLeastSide, height};
    const auto found = refit(patch, whole, spacing, moments_of_slab(patch, *best, false), limits, side);
    if (!found || !(side.deviation < whole.deviation && side.variance < kFlatter * whole.variance))
        return std::nullopt;
    if (std::abs(found->slab.level) > kMostOff * spacing) return std::nullopt;  // it is another face
    const Excess& excess = noisy_plane ? kNoiseExcess : kNarrowExcess;
    if (!stands_out(found->own.count, found->slab.limit, patch, patch.count, excess)) return std::nullopt;
    const auto scattered = find_creases(patch, *found, spacing, side);
    if (!scattered || *scattered > patch.count / kScattered) return std::nullopt;
    return side;
}

}  // namespace lucarne::octree
