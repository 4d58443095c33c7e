#include "viewer/opening/site.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "octree/tree/robust_bounds.h"
#include "viewer/opening/colour_cast.h"
#include "viewer/opening/occupancy.h"
#include "viewer/opening/standing_place.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostNodes = 64;
constexpr size_t kMostOutline = 5000;

/// Share of the places to stand that are in rooms from which a scan is one of rooms.
constexpr double kInterior = .5;
/// Samples of one scan differ by as much in that share.
constexpr double kUncertain = .1;
/// Height over width up to which a single layer is terrain, and the share of its columns that are thin.
constexpr double kFlat = .35, kThinColumns = .8;
constexpr int kThin = 3;  ///< cells
/// Metres between the places that are known of a scan with gaps, beyond which it is not said to be one of
/// rooms. People do not pass through such gaps.
constexpr double kWidestGap = .5;
constexpr double kCoarser = 1.5;
/// Share of a site that a station sees at least. Cells hide what a scanner saw at a flat angle.
constexpr double kSeen = .65, kOwnCells = 3;
constexpr size_t kMostLooks = 500;

struct CoarsePoints {
    std::vector<glm::dvec3> positions;  ///< world units
    ColourCast cast;
};

/// Returns what the coarsest nodes contain, level by level.
CoarsePoints coarse_points(const octree::NodeSource& source) {
    CoarsePoints found;
    auto& points = found.positions;
    std::vector<uint32_t> open = source.roots();
    const auto nodes = source.nodes();
    for (size_t next = 0; next < open.size() && next < kMostNodes && points.size() < kEnoughPoints; ++next) {
        const uint32_t node = open[next];
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[node].child(octant); child != octree::kNoNode)
                open.push_back(child);
        const auto data = source.load(node);
        if (!data) continue;  // the picture lacks it as well
        const octree::SourcePart part = source.part_of(node);
        const io::Schema& schema = part.header.schema;
        const auto& scans = part.header.scans;
        const double white = io::color_white(scans.empty() ? 0 : scans.front().color_bits);
        for (uint32_t i = 0; i < data->count; ++i) {
            const std::byte* record = &data->records[size_t{i} * schema.stride];
            points.push_back(io::position_of(schema, record) * part.scale);
            found.cast.add(schema, record, white);
        }
    }
    return found;
}

/// Whether the grid contains one layer, much wider than high.
bool is_terrain(const OccupancyGrid& grid, const std::array<glm::dvec3, 2>& box) {
    const glm::dvec3 sides = box[1] - box[0];
    if (sides.z > kFlat * std::max(sides.x, sides.y)) return false;
    const glm::ivec3 size = grid.size();
    size_t columns = 0, thin = 0;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            int low = size.z, high = -1;
            for (int z = 0; z < size.z; ++z)
                if (grid.occupied({x, y, z})) low = std::min(low, z), high = z;
            if (high < 0) continue;
            ++columns;
            thin += high - low < kThin;
        }
    return columns > 1 && static_cast<double>(thin) >= kThinColumns * static_cast<double>(columns);
}

/// Returns what a view of all has to contain: the cells with points, or the corners of the box if there are
/// none.
std::vector<glm::dvec3> outline_of(const OccupancyGrid& grid, const std::array<glm::dvec3, 2>& box) {
    std::vector<glm::dvec3> all = grid.occupied_middles(), some;
    for (size_t i = 0; i < std::min(all.size(), kMostOutline); ++i)
        some.push_back(all[i * all.size() / std::min(all.size(), kMostOutline)]);
    if (!some.empty()) return some;
    for (int corner = 0; corner < 8; ++corner)
        some.emplace_back(box[corner & 1].x, box[corner >> 1 & 1].y, box[corner >> 2 & 1].z);
    return some;
}

/// Whether most of some places can be seen from a station. Files may state one for points of many.
bool sees(const OccupancyGrid& grid, const glm::dvec3& station, std::span<const glm::dvec3> places) {
    if (!std::isfinite(glm::length(station))) return false;
    const size_t looks = std::min(places.size(), kMostLooks);
    size_t seen = 0;
    for (size_t i = 0; i < looks; ++i) {
        const glm::dvec3& place = places[i * places.size() / looks];
        const double distance = glm::distance(place, station);
        // From the place, because the station may be outside the grid, and past the cells of its own surface.
        const double first = kOwnCells * grid.cell();
        if (distance <= first) {
            ++seen;
            continue;
        }
        const glm::dvec3 toward = (station - place) / distance;
        const OccupancyGrid::Sight sight = grid.look(place + first * toward, toward);
        seen += !sight.blocked || first + sight.distance >= distance;
    }
    return static_cast<double>(seen) >= kSeen * static_cast<double>(looks);
}

ScannerPlaces stations_of(const octree::NodeSource& source) {
    const octree::SourceHeader& header = source.header();
    ScannerPlaces found;
    if (source.parts() != 1) return found;  // their units may differ
    for (const io::ScanInfo& scan : header.scans)
        for (const io::Station& station : scan.stations) found.places.push_back(station.position);
    const bool stated = !found.places.empty();
    for (const octree::EstimatedStation& station : header.estimated_stations)
        found.places.push_back(station.position);
    if (header.scans.size() == 1 && found.places.size() == 1 &&
        (stated || header.estimated_stations.front().saw_all))
        found.only = found.places.front();
    return found;
}

}  // namespace

std::string_view site_name(SiteKind kind) {
    static constexpr std::array<std::string_view, 3> kNames = {"object", "terrain", "interior"};
    return kNames[static_cast<size_t>(kind)];
}

Site survey_site(std::span<const glm::dvec3> points, const std::array<glm::dvec3, 2>& box,
                 double metres_per_unit, bool has_gaps, const ScannerPlaces& stations) {
    Site site;
    site.box = box;
    if (!std::isfinite(glm::length(box[0]) + glm::length(box[1])))
        site.box = {glm::dvec3(-1), glm::dvec3(1)};  // an empty cloud: nothing to frame
    site.metres_per_unit = metres_per_unit;
    OccupancyGrid grid(points, site.box);
    Standing standing = find_standing_place(grid, metres_per_unit, stations.places);
    // Points that lie close together in some places choose cells that are finer than the gaps between the
    // places, and walls let rays through.
    const double widest = kWidestGap / metres_per_unit;
    for (double cell = kCoarser * grid.cell(); has_gaps && cell <= widest; cell *= kCoarser) {
        OccupancyGrid coarse(points, site.box, cell);
        Standing there = find_standing_place(coarse, metres_per_unit, stations.places);
        if (there.enclosed_share < std::max(kInterior, standing.enclosed_share)) continue;
        grid = std::move(coarse);
        standing = std::move(there);
    }
    site.outline = outline_of(grid, site.box);
    site.inside = standing.best;
    site.enclosed_share = standing.enclosed_share;
    if (standing.enclosed_share >= kInterior)
        site.kind = SiteKind::interior;
    else if (is_terrain(grid, site.box))
        site.kind = SiteKind::terrain;
    const bool from_inside = site.kind == SiteKind::interior && site.inside;
    if (stations.only && !from_inside && sees(grid, *stations.only, site.outline))
        site.station = stations.only;
    return site;
}

Site survey_site(const octree::NodeSource& source) {
    const CoarsePoints found = coarse_points(source);
    const auto& points = found.positions;
    const bool has_gaps = source.header().has_gaps;
    Site site = survey_site(points, octree::robust_bounds(source), source.header().metres_per_unit, has_gaps,
                            stations_of(source));
    site.cast = found.cast.result();
    site.coloured = found.cast.coloured();
    site.brightness = found.cast.brightness();
    // A source of many nodes is no sketch, even if the coarsest ones have few points.
    site.sure = !has_gaps && (points.size() >= kEnoughPoints || source.nodes().size() > kMostNodes);
    return site;
}

bool shown_alike(const Site& a, const Site& b) {
    if (a.kind != SiteKind::interior || b.kind != SiteKind::interior || !a.inside || !b.inside) return true;
    constexpr double kTurned = .7, kMoved = .25;  // cosine; share of the free distance ahead
    const double moved = glm::distance(a.inside->eye, b.inside->eye);
    return dot(a.inside->ahead, b.inside->ahead) >= kTurned &&
           moved <= kMoved * std::min(a.inside->free_ahead, b.inside->free_ahead);
}

bool alike(const Site& a, const Site& b) {
    constexpr double kSame = .05;  // of the diagonal
    const double size = std::max(glm::distance(a.box[0], a.box[1]), glm::distance(b.box[0], b.box[1]));
    const double moved = std::max(glm::distance(a.box[0], b.box[0]), glm::distance(a.box[1], b.box[1]));
    const auto between = [](const Site& site) {
        return std::abs(site.enclosed_share - kInterior) <= kUncertain;
    };
    const bool same_kind = a.kind == b.kind || (between(a) && between(b));
    return same_kind && a.inside.has_value() == b.inside.has_value() && moved <= kSame * size;
}

}  // namespace lucarne::viewer
