#include "octree/normals/normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/estimate_range.h"
#include "octree/normals/surface/board_ends.h"
#include "octree/normals/surface/chunk_surface.h"
#include "octree/normals/surface/edge_agreement.h"

namespace lucarne::octree {
namespace {

/// Sine of the least angle between a normal's plane and the ray to the station. At flatter angles the normal
/// does not tell which side the station saw.
constexpr double kGrazing = 0.05;
/// Sine of the largest angle between a silhouette's tangent plane and the rays that graze it. A plane fitted
/// to a pier covers some degrees of its curve.
constexpr double kSilhouette = 0.1;
/// The same for groups of points that are far sparser than the surfaces around them: their planes are
/// rougher.
constexpr double kCurtain = 0.3;
constexpr float kRough = 64;  ///< crowding from which kCurtain is used

/// Least |n.n'| of a side of a crease and its whole neighbourhood where no station is known: 53 degrees, so
/// that both sides of a right-angled edge count. Sides that turn farther may face either way.
constexpr float kLeastTurn = 0.6f;
/// Below this |n.n'| the whole neighbourhood does not tell which way a side faces, but its
/// station does.
constexpr float kOwnTurn = 0.5f;

/// A halo may take 1/kHaloMemory of the memory: two chunks are processed at a time even if memory is short.
constexpr uint64_t kHaloMemory = 8;

/// What is known of one chunk before the components of all chunks are joined.
struct ChunkEstimate {
    ChunkNeighbours neighbours;
    ChunkSurface surface;
    ChunkOrientation orientation;
};

/// Drops sparse points beside denser surfaces whose plane contains their station, too. They are no surface:
/// mixed pixels behind a silhouette lie on the rays that graze it, and form a curtain in the silhouette's
/// tangent plane. The sparser they are, the rougher the plane of the curtain may be.
void drop_curtains(ChunkSurface& surface, std::span<const glm::dvec3> ray_of_site) {
    const auto drop = [&](uint32_t site, double sine) {
        const glm::dvec3& ray = ray_of_site[site];
        const double facing = std::abs(glm::dot(glm::dvec3(surface.normals[site]), ray));
        if (!(glm::length(ray) > 0 && facing <= sine * glm::length(ray))) return;
        surface.normals[site] = glm::vec3(0.0f);
        surface.areas[site] = kStrayArea;
    };
    for (const uint32_t site : surface.apart) drop(site, kSilhouette);
    for (const auto& [site, crowding] : surface.crowded)
        drop(site, crowding < kRough ? kSilhouette : kCurtain);
}

/// Narrows the discs at outer edges beyond which several planes lie, as at the corner of a box. In a corner
/// of a room they end behind the other sides, and their size keeps the corner closed. The station tells which
/// of the two it is.
void narrow_at_corners(ChunkSurface& surface, std::span<const glm::dvec3> ray_of_site) {
    for (SiteLine& line : surface.lines) {
        const glm::dvec3& ray = ray_of_site[line.site];
        const double facing = glm::dot(glm::dvec3(line.normal), ray);
        if (!(std::abs(facing) > kGrazing * glm::length(ray))) continue;
        if ((facing > 0 ? line.beyond : turned(line.beyond)) == Beyond::falls) {
            float& area = surface.areas[line.site];
            area = std::min(area, line.most_area);
        }
        line.most_area = std::numeric_limits<float>::infinity();  // decided
    }
}

/// Drops the sides of creases that turn far and have no station, with their lines. Others are oriented by
/// their own normal where that of the whole neighbourhood would mislead. Only where normals are estimated:
/// stated ones face the right way, and a line whose side is in another plane is left out later.
void drop_doubtful_sides(ChunkSurface& surface, std::span<const glm::dvec3> ray_of_site) {
    auto line = surface.lines.begin();
    std::erase_if(surface.sides, [&](const SideNormal& side) {
        if (!ray_of_site.empty() && ray_of_site[side.site] != glm::dvec3(0.0)) {
            if (std::abs(glm::dot(side.normal, surface.normals[side.site])) < kOwnTurn)
                surface.normals[side.site] = side.normal;
            return false;
        }
        if (std::abs(glm::dot(side.normal, surface.normals[side.site])) >= kLeastTurn) return false;
        while (line != surface.lines.end() && line->site < side.site) ++line;
        if (line != surface.lines.end() && line->site == side.site) line->toward = glm::vec3(0.0f);
        return true;
    });
    std::erase_if(surface.lines, [](const SiteLine& dropped) { return dropped.toward == glm::vec3(0.0f); });
}

/// Returns the scaled ray from each site to the station that saw it. The site's first point with a known
/// station decides; the ray is zero if there is none.
Result<std::vector<glm::dvec3>> rays_to_stations(const ChunkCache& cache, size_t chunk,
                                                 const NormalOptions& options,
                                                 const ChunkNeighbours& neighbours) {
    const double scale = cache.scale();
    std::vector<glm::dvec3> rays(options.stations.empty() ? 0 : neighbours.site_count(), glm::dvec3(0.0));
    if (rays.empty()) return rays;
    LUCARNE_ASSIGN(const auto stations, cache.chunks().stations(chunk));
    for (uint32_t site = 0; site < rays.size(); ++site)
        for (const uint32_t point : neighbours.members(site)) {
            const int32_t station = point < stations.size() ? stations[point] : -1;
            if (station < 0 || static_cast<size_t>(station) >= options.stations.size()) continue;
            rays[site] = scale * options.stations[static_cast<size_t>(station)] - neighbours.position(site);
            break;
        }
    return rays;
}

/// Returns the side of each site's normal that its station saw: 1, -1, or 0 where it is unknown.
std::vector<int8_t> toward_stations(const ChunkSurface& surface, std::span<const glm::dvec3> rays) {
    std::vector<int8_t> toward(surface.normals.size(), 0);
    for (size_t site = 0; site < rays.size(); ++site) {
        const double facing = glm::dot(glm::dvec3(surface.normals[site]), rays[site]);
        if (std::abs(facing) > kGrazing * glm::length(rays[site])) toward[site] = facing > 0 ? 1 : -1;
    }
    return toward;
}

Result<ChunkEstimate> estimate_chunk(ChunkCache& cache, size_t chunk, const NormalOptions& options,
                                     const OrientationDetail& detail) {
    LUCARNE_ASSIGN(auto neighbours,
                   ChunkNeighbours::load(cache, chunk, options.search, options.memory / kHaloMemory));
    LUCARNE_ASSIGN(auto surface, estimate_surface(neighbours, options.neighbours));
    neighbours.drop_indices();
    LUCARNE_ASSIGN(const auto rays, rays_to_stations(cache, chunk, options, neighbours));
    if (!rays.empty()) {
        drop_curtains(surface, rays);
        take_seen_ends(surface, rays);
        narrow_at_corners(surface, rays);
    }
    if (options.normals) drop_doubtful_sides(surface, rays);
    agree_on_lines(neighbours, surface);
    ChunkOrientation orientation;
    if (options.normals) {
        orientation = orient_chunk(neighbours, surface, toward_stations(surface, rays), detail);
    } else {
        orientation.components.assign(neighbours.site_count(), 0);
    }
    return ChunkEstimate{std::move(neighbours), std::move(surface), std::move(orientation)};
}

/// Converts an area in squares of `length` to squares of 1. The marks for unknown areas and outliers stay
/// unchanged.
float in_squares(float area, double length) {
    if (!(area > kStrayArea)) return area;
    constexpr double kLeast = std::numeric_limits<float>::min(), kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(area * length * length, kLeast, kMost));
}

/// Returns PointEdge::narrowed, for what narrow_at_corners does where no station tells outer edges from
/// corners.
uint8_t narrowed(float most_area, float area) {
    return most_area < area ? static_cast<uint8_t>(std::max(1.0f, std::round(255 * most_area / area))) : 255;
}

/// Converts results from sites to points, in their stored order. The points of a site share its area. `unit`
/// is the length unit of the estimate's areas, in the wanted unit. `sites_too`: also site_normals.
ChunkNormals points_of(const ChunkEstimate& estimate, double unit, bool sites_too) {
    const auto sites = static_cast<uint32_t>(estimate.neighbours.site_count());
    const size_t points = estimate.neighbours.point_count();
    ChunkNormals normals;
    normals.normals.resize(points);
    normals.areas.resize(points);
    normals.components.resize(points);
    normals.edges.resize(points);
    if (sites_too) normals.site_normals.resize(points);
    auto side = estimate.surface.sides.begin();
    auto line = estimate.surface.lines.begin();
    for (uint32_t site = 0; site < sites; ++site) {
        const auto members = estimate.neighbours.members(site);
        glm::vec3 normal = estimate.surface.normals[site];
        const float area = estimate.surface.areas[site] / static_cast<float>(members.size());
        PointEdge edge;
        for (; side != estimate.surface.sides.end() && side->site == site; ++side)
            if (normal != glm::vec3(0.0f)) {
                normal = glm::dot(side->normal, normal) < 0 ? -side->normal : side->normal;
            }
        for (; line != estimate.surface.lines.end() && line->site == site; ++line)
            if (normal != glm::vec3(0.0f))
                edge = {encode_edge(normal, {line->toward, line->distance / std::sqrt(area)}),
                        glm::dot(line->normal, normal) < 0 ? turned(line->beyond) : line->beyond,
                        narrowed(line->most_area, estimate.surface.areas[site])};
        for (const uint32_t point : members) {
            normals.normals[point] = normal;
            if (sites_too) normals.site_normals[point] = estimate.surface.normals[site];
            normals.edges[point] = edge;
            normals.areas[point] = in_squares(area, unit);
            normals.components[point] = estimate.orientation.components[site];
        }
    }
    return normals;
}

/// Returns the end of the range of chunks [first, most) that fit into the memory together; at least one.
size_t wave_end(const ChunkAccess& chunks, size_t first, size_t most, uint64_t memory) {
    uint64_t bytes = 0;
    size_t end = first;
    for (; end < most; ++end) {
        bytes += chunks.point_count(end) * kNormalBytesPerPoint;
        if (end > first && bytes > memory) break;
    }
    return end;
}

}  // namespace

Result<OrientationSigns> estimate_normals(
    const ChunkAccess& chunks, const NormalOptions& options,
    const std::function<Result<void>(size_t chunk, ChunkNormals&&)>& sink) {
    OrientationMerger merger(OrientationDetail::of(chunks, options.memory));
    const ChunkRange all{0, chunks.chunk_count()};
    LUCARNE_TRY(estimate_range(chunks, all, options, sink, [&](ChunkVotes&& votes) { merger.add(votes); }));
    return merger.signs();
}

Result<std::vector<BorderMessage>> estimate_range(
    const ChunkAccess& chunks, ChunkRange range, const NormalOptions& options,
    const std::function<Result<void>(size_t chunk, ChunkNormals&&)>& sink,
    const std::function<void(ChunkVotes&&)>& orient) {
    if (options.neighbours < 3 || options.neighbours > kMostNormalNeighbours)
        return bad_arguments("normals", fmt::format("{} neighbours; must be 3 to {}", options.neighbours,
                                                    kMostNormalNeighbours));
    const ThreadLimit threads(options.threads);
    ChunkCache cache(chunks, options.memory / 8);
    const double unit = 1 / cache.scale() / options.area_unit;
    const auto detail = OrientationDetail::of(chunks, options.memory);
    BorderMail mail(range.end, detail);
    for (size_t first = range.first, last; first < range.end; first = last) {
        last = wave_end(chunks, first, range.end, options.memory / 2);
        std::vector<std::optional<ChunkEstimate>> wave(last - first);
        FirstError error;
        parallel_ranges(wave.size(), 1, [&](size_t i, size_t) {
            if (chunks.point_count(first + i) == 0) return;
            auto estimate = estimate_chunk(cache, first + i, options, detail);
            if (estimate)
                wave[i] = std::move(*estimate);
            else
                error.report(i, std::move(estimate).error());
        });
        LUCARNE_TRY(error.result());
        for (size_t i = 0; i < wave.size(); ++i)
            orient(wave[i] ? mail.finish(static_cast<uint32_t>(first + i), wave[i]->neighbours,
                                         wave[i]->surface, wave[i]->orientation)
                           : ChunkVotes{});
        parallel_ranges(wave.size(), 1, [&](size_t i, size_t) {
            auto done =
                sink(first + i, wave[i] ? points_of(*wave[i], unit, options.site_normals) : ChunkNormals{});
            if (!done) error.report(i, std::move(done).error());
        });
        LUCARNE_TRY(error.result());
    }
    return mail.take_outgoing();
}

}  // namespace lucarne::octree
