#include "octree/normals/surface/chunk_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include <glm/geometric.hpp>
#include <tbb/enumerable_thread_specific.h>

#include "io/core/parallel.h"
#include "octree/normals/surface/bent_rim.h"
#include "octree/normals/surface/crease.h"
#include "octree/normals/surface/earned.h"
#include "octree/normals/surface/group.h"
#include "octree/normals/surface/surface_sample.h"
#include "octree/normals/surface/surface_share.h"
#include "octree/tree/footprint.h"

namespace lucarne::octree {
namespace {

constexpr size_t kNearEdges = 4;  ///< of kSiteEdges; the others are spread over the rest of the neighbourhood
constexpr size_t kBorderEdges = 2;  ///< edges of a site to the nearest points of other chunks
/// Where the normal is uncertain, all points within this many times the distance of the k-th neighbour are
/// used: the window. On a surface it holds four times as many points.
constexpr double kWindow = 2.0;
/// If the window holds more than kMostWindow times k points, as at the rim of a dense patch, it is narrowed
/// to about kUsualWindow times k.
constexpr size_t kMostWindow = 6, kUsualWindow = 4;
/// Neighbours whose variance across their main axis is below this share of that along it lie on a line, such
/// as one scan line.
constexpr float kLine = 0.05f;
/// If the heights in the window have this many times the variance of those of the neighbours, the surface
/// bends. Noise has the same in both.
constexpr float kBend = 1.5f;
/// From this ratio on narrow faces are looked for, and from kBend on if the window's normal is so uncertain
/// (4.5 degrees): noise of half a spacing and more has planes with many points, too.
constexpr float kClearBend = 3.0f, kUneven = 0.08f;
/// A share is at most kMostShares of those of the neighbours, except that of a sparse point in the plane of a
/// dense patch. Only shares of more than kWide times the mean of the neighbourhood are compared.
constexpr float kMostShares = 4, kWide = 1.5f;
/// A site whose neighbourhood is this many times wider than the distance from one site to the next nearby may
/// hang in the air beside a much denser surface. The ratio is 2 to 3 on a surface of even density.
constexpr double kSparse = 8;
/// From this ratio on a site must have earned its size (earned.h).
constexpr double kThin = 4;
/// Neighbours whose variance across their main axis is below this share of that along it are a strip, such as
/// a wire or the rim of a pane: two points wide, or three. Half a disc has .28.
constexpr float kStrip = 0.13f;
/// A disc is doubtful (earned.h) if its normal is known no better than to this, radians, and if its
/// neighbours' variance across their main axis is below this share of that along it, or it is sparse (kThin).
/// Of even surfaces the normal is known to .01 to .02, and noise is smoothed by the window.
constexpr float kDoubtfulDeviation = 0.04f, kDoubtfulStrip = 0.4f;
/// Largest share of a point of a strip, in those of the neighbours.
constexpr float kMostOfStrip = 1.0f;
/// From this ratio on the group of points in the air may be farther from the surface than kWindow.
constexpr double kVerySparse = 24, kFarWindow = 4;
/// If the window of such a site holds this many times what a surface of the site's own density has there, the
/// site is crowded. Within a sheet the number is 1.
constexpr float kCrowded = 8;
/// Of a site that is more crowded than this, the whole window is asked whether its disc has earned its size.
/// Sites of a sparse wall above a dense floor are less crowded.
constexpr float kVeryCrowded = 16;
/// A very sparse site that is more crowded than this is an outlier.
constexpr float kMostCrowded = 64;
/// A disc at an outer edge ends that many spacings beyond the line where the two planes meet, and by this
/// share of the other plane's roughness farther, so that the discs of both sides meet there; but at most
/// kOverEdge spacings. Where several planes lie beyond, the whole disc reaches no farther than that.
constexpr float kBeyondEdge = 0.05f, kRoughEdge = 0.25f, kOverEdge = 0.5f;
/// At a border points up to so many deviations of the heights, and so many spacings more, over the tangent
/// plane belong to the surface.
constexpr float kRoughLevel = 3.0f, kFlatLevel = 0.1f;
/// Points nearer to their border than this, in spacings, are the outermost: it stands .375 beyond them.
constexpr float kOutermost = 1.0f;
/// Largest share of a point of a narrow face, in squares of the spacing of all points around.
constexpr float kMostNarrow = 1.2f;
/// Where the points beyond a crease lie up to so many spacings off a plane, they are one plane, and the cell
/// ends where it begins. Else their points cut the cell, too: several planes, as at the corner of a box.
constexpr float kRoughSide = 0.5f;
/// A crease may be none if the points beyond it lie so many spacings off a plane, as on a pipe. Else a border
/// gives the line only if it is this much nearer: at the corner of a box both are there.
constexpr float kDoubtful = 0.15f, kMuchNearer = 0.5f;
/// A border may lie so many spacings farther out than it is taken to be.
constexpr float kBorderDoubt = 0.125f;
/// A point farther from a dense patch than this many of the patch's spacings is too far for the patch's plane
/// to tell; and for the plane of many of its points, whose normal must be known to kClearDeviation radians.
/// Floors below scanners have up to .018 there, the piece of a cable that got a plate .03.
constexpr float kMostApart = 10.0f, kMostApartOfMany = 20.0f, kClearDeviation = 0.02f;
constexpr size_t kStepSites = 256;  ///< sites whose steps are compared: a piece of the Morton curve

/// The median distance from one site to the next along the Morton curve, for each kStepSites sites.
std::vector<double> median_steps(const ChunkNeighbours& neighbours) {
    const size_t sites = neighbours.site_count();
    std::vector<double> medians((sites + kStepSites - 1) / kStepSites);
    parallel_ranges(medians.size(), 64, [&](size_t first, size_t last) {
        std::vector<double> steps;
        for (size_t block = first; block < last; ++block) {
            steps.clear();
            const size_t end = std::min(sites - 1, (block + 1) * kStepSites);
            for (size_t i = block * kStepSites; i < end; ++i)
                steps.push_back(glm::distance(neighbours.position(static_cast<uint32_t>(i)),
                                              neighbours.position(static_cast<uint32_t>(i + 1))));
            const auto middle = steps.begin() + static_cast<ptrdiff_t>(steps.size() / 2);
            std::nth_element(steps.begin(), middle, steps.end());
            medians[block] = middle == steps.end() ? 0 : *middle;
        }
    });
    return medians;
}

/// Returns the line of a site's side of a crease, where its disc ends if the crease is an outer edge.
SiteLine line_at(uint32_t site, const Side& side, float spacing) {
    const auto n = glm::vec3(side.plane.normal);
    const Crease& crease = side.first;
    const glm::vec3 across = crease.other - n * glm::dot(crease.other, n);
    const float slope = glm::length(across);  // over .4: planes at a crease meet at 24 degrees and more
    const float beyond =
        std::min(kBeyondEdge * spacing + kRoughEdge * crease.roughness / slope, kOverEdge * spacing);
    SiteLine line{site, n, across / (crease.offset < 0 ? -slope : slope), crease.distance + beyond,
                  crease.rises ? Beyond::rises : Beyond::falls};
    const bool rough = crease.roughness > kRoughSide * spacing;
    if (rough || side.second.distance > 0) {
        const float radius = (rough ? crease.distance : side.second.distance) + kOverEdge * spacing;
        line.most_area = std::numbers::pi_v<float> / kCoverageRaw * radius * radius;
    }
    return line;
}

/// Estimates the surface at one site after another; one per thread.
class SiteEstimator {
 public:
    SiteEstimator(ChunkNeighbours& neighbours, size_t usual, std::span<const double> steps,
                  ChunkSurface& surface)
        : neighbours_(neighbours), usual_(usual), steps_(steps), surface_(surface) {}

    /// Estimates the surface at a site. Returns 0, or the radius that must be known around the site first.
    double visit(uint32_t site, const Patch& nearest, ChunkNeighbours::Surroundings& around) {
        if (nearest.count < kLeastPoints) return 0;
        const bool whole_cloud = nearest.count < usual_;
        bool apart = false;
        if (!whole_cloud && is_stray(nearest, usual_, false)) {
            apart = goes_on_with(nearest);
            if (!apart && is_near_enough(nearest, kMostApartOfMany)) {
                // The nearest may all be of one scan line, through which many planes go.
                around.nearest(kMostNearest, further_);
                const double known = std::sqrt(double{further_.distance2[further_.count - 1]});
                if (!around.knows(known)) return known;
                apart = fitter_.lies_in_plane_of_others(further_, kClearDeviation);
            }
            if (!apart) return leave_out(site);
        }
        const float reach2 = nearest.distance2[nearest.count - 1], reach = std::sqrt(reach2);
        const float spacing =
            std::sqrt(std::numbers::pi_v<float> * reach2 / static_cast<float>(nearest.count - 1));
        float crowding = 0;
        const double sparser = whole_cloud ? 0 : reach / step_near(site);
        if (sparser > kThin && neighbours_.site_count() > kStepSites) {
            const GroupSearch group = find_gap(around, reach, distances2_);
            if (group.radius > 0) return group.radius;
            if (group.alone) return leave_out(site);
        }
        if (sparser > kSparse) {
            const double times = sparser > kVerySparse ? kFarWindow : kWindow;
            if (!around.knows(times * reach)) return times * reach;
            crowding = crowding_at(around, reach, times);
            if (sparser > kVerySparse && crowding > kMostCrowded) return leave_out(site);
        }
        const Patch* patch = &nearest;  // the patch of the fit
        SurfaceFit fit = fitter_.fit(nearest, spacing);
        std::optional<Side> side;
        bool narrow = false;    // the side is looked for as a narrow face
        glm::vec3 whole(0.0f);  // the normal of the whole neighbourhood at a crease
        double seen = reach;    // all points nearer than this are in `patch`
        std::optional<BentRim> bent;
        if (sparser > kSparse && fit.deviation < kPoorDeviation) bent = fit_bent_rim(nearest, fit);
        const bool blurred = fit.roundness < kLine || !(fit.deviation < kPoorDeviation);
        if (fit.deviation > kGoodDeviation && !whole_cloud) {
            if (!around.knows(kWindow * reach)) return kWindow * reach;
            seen = take_window(around, reach);
            bool bends = false, clearly = false;
            SurfaceFit wide = fit;
            if (window_.count > nearest.count) {
                wide = fitter_.fit(window_, spacing);
                const bool uneven = wide.deviation > kUneven && wide.variance > kBend * fit.variance;
                clearly = uneven || wide.variance > kClearBend * fit.variance;
                bends = wide.variance > kBend * fit.variance || !(wide.deviation < kGoodDeviation);
                patch = improve(fit, wide, window_, *patch);
            }
            const size_t most = std::min(kUsualWindow * (usual_ - 1), kMostNearest - 1) + 1;
            // The window was narrowed: it held too many points.
            const bool cut_short = seen < kWindow * reach;
            further_.clear();
            if (window_.count >= most) {
                if (window_.count > kMostWindow * usual_ || may_stand_apart(nearest, window_)) {
                    const size_t all = window_.count;
                    further_.take_nearest(window_, most);  // the window may hold very many points
                    if (window_.count < all) seen = std::sqrt(double{further_.distance2[further_.count - 1]});
                }
            } else if (cut_short || !(fit.deviation < kPoorDeviation)) {  // or nearly isolated, or on a line
                around.nearest(most, further_);
                const double known = std::sqrt(double{further_.distance2[further_.count - 1]});
                if (!around.knows(known)) return known;
                patch = improve(fit, fitter_.fit(further_, spacing), further_, *patch);
            }
            // A few points in the air together are each other's neighbours; more neighbours show that they
            // are isolated.
            if (further_.count == most && is_stray(further_, usual_, true)) {
                apart = goes_on_with(further_);
                if (!apart) return leave_out(site);
            }
            if (bends) {
                if (fit.deviation < kPoorDeviation) side = fit_side(window_, fit, spacing);
                const bool poor = !(fit.deviation < kPoorDeviation);
                narrow = !side && (clearly || poor) && sparser <= kSparse;
                if (narrow) side = fit_narrow_side(nearest, window_, wide, spacing, !poor);
            }
            if (side && bent && bent->variance < side->variance) side.reset();
            if (side) {
                bent.reset();
                patch = &window_;
                whole = fit.deviation < kPoorDeviation ? fit.normal : glm::vec3(side->plane.normal);
                fit.normal = glm::vec3(side->plane.normal);
                fit.deviation = side->deviation;
                fit.variance = side->variance;
                fit.layer = side->layer;
            }
        }
        if (bent) {
            patch = &nearest;
            fit.normal = bent->normal;
            fit.variance = bent->variance;
            fit.layer = bent->layer;
        }
        connect(site, nearest, blurred && patch != &nearest ? patch : nullptr, side ? whole : fit.normal);
        if (!(fit.deviation < kPoorDeviation)) {
            // A blob has no disc. An outlier must not get the area of the empty space around it.
            const float most = sparser > kThin ? lone_area(nearest.distance2[1]) : spacing * spacing;
            surface_.areas[site] = std::min({most, spacing * spacing, share_of_neighbours(nearest)});
            return 0;
        }
        if (patch != &window_) seen = reach;  // at least
        ShareCell cell(fit.normal, reach, nearest.count - 1, static_cast<float>(seen), apart);
        heights_over(*patch, fit.normal, heights_);
        const bool rough = side && side->first.roughness > kRoughSide * spacing;
        if (side && !rough) leave_to_other_sides(*side);
        cell.cut(*patch, heights_, fit.layer, rough);
        if (side)
            for (const Crease& crease : {side->first, side->second})
                if (crease.distance > 0) cell.cut_at(crease.other, crease.offset);
        const float rim = std::numbers::sqrt2_v<float> / 2 * spacing;
        float area = 0;
        std::optional<glm::vec3> outward;
        if (cell.open()) {
            if (!around.knows(cell.widest_search())) return cell.widest_search();
            const auto view = around.around(std::min(cell.widest_search(), cell.widest_cut()));
            const size_t beyond = cell.cut_open(view.tile, view.centre, static_cast<float>(view.radius));
            if (apart && !cell.closed()) return leave_out(site);
            if (beyond < view.tile.count) connect_rim(site, view, beyond);
            outward = cell.outward();
            area = cell.area_at_rim();
        } else {
            outward = cell.outward();
            area = cell.area();
        }
        std::optional<SiteLine> border;
        if (outward) {
            if (!around.knows(kBorderLook * rim)) return kBorderLook * rim;
            border = border_at(site, *outward, around, fit, rim);
        }
        if (border && side) {
            cell.cut_at(border->toward, border->distance);
            area = cell.area();
        }
        if (!side && sparser > kThin && fit.roundness < kStrip)
            if (const float most = most_of_strip(nearest); area > kWide * most) area = most;
        const bool wide = area > kWide * spacing * spacing;
        if (wide || apart || sparser > kThin) {
            // What crowds a site may be farther away than its disc reaches.
            const double look = std::max(double{kEarnedLook * surfel_radius(area, 0)},
                                         crowding > kVeryCrowded ? kWindow * reach : 0.0);
            if (!around.knows(look)) return look;
            const bool doubtful = !side && fit.deviation > kDoubtfulDeviation &&
                                  (fit.roundness < kDoubtfulStrip || sparser > kThin);
            const float earned =
                earned_at(around, look, {fit.normal, surfel_radius(area, 0), sparser > kThin, doubtful});
            if (apart && earned < area) return leave_out(site);
            area = std::min(area, earned);
            if (wide && !apart) area = std::min(area, most_beside(nearest, area));
        }
        if (side && narrow) area = std::min(area, kMostNarrow * spacing * spacing);
        surface_.areas[site] = area;
        const bool creased = side && side->first.distance > 0;
        std::optional<SiteLine> line;
        if (creased) line = line_at(site, *side, spacing);
        // The surface of a thin pipe has a border nearby as well as a crease.
        const float to_crease = creased ? side->first.distance : std::numeric_limits<float>::infinity();
        const bool doubtful_crease = creased && side->first.roughness > kDoubtful * spacing;
        if (border && border->distance + kBorderDoubt * rim <=
                          (doubtful_crease || !creased ? 1.0f : kMuchNearer) * to_crease)
            line = border;
        if (line) lines_.push_back(*line);
        const bool at_border = std::min(to_crease, border ? border->distance : to_crease) < kOutermost * rim;
        surface_.normals[site] = whole != glm::vec3(0.0f) ? whole : fit.normal;
        if (whole != glm::vec3(0.0f)) {
            sides_.push_back({site, fit.normal, at_border ? side->layered : glm::vec3(0.0f)});
        }
        if (apart) apart_.push_back(site);
        if (crowding > kCrowded) crowded_.push_back({site, crowding});
        return 0;
    }
    /// Decides about a site whose neighbours are not all known, only those within `certain`. It stays without
    /// a surface, and is an outlier if those that are known say so and it is far from all others.
    void give_up(uint32_t site, const Patch& known, double certain) {
        const double sparse = kSparse * step_near(site);
        if (known.count < usual_ || certain < sparse) return;
        const bool far = known.distance2[1] > 4 * sparse * sparse;
        if (far || is_stray(known, usual_, true)) leave_out(site);
    }
    std::span<const uint32_t> apart() const { return apart_; }
    std::span<const SideNormal> sides() const { return sides_; }
    std::span<const SiteLine> lines() const { return lines_; }
    std::span<const CrowdedSite> crowded() const { return crowded_; }
    std::span<const BorderEdge> border() const { return border_; }

 private:
    static constexpr size_t kLeastPoints = 4, kMostNearest = 128;

    /// Whether a point that looks isolated belongs to its neighbours' surface nevertheless.
    bool goes_on_with(const Patch& others) {
        return is_near_enough(others, kMostApart) && fitter_.lies_in_plane_of_others(others);
    }

    /// The distance between sites at the densest surface near a site, roughly.
    double step_near(uint32_t site) const {
        const size_t block = site / kStepSites, last = std::min(steps_.size() - 1, block + 1);
        return *std::min_element(steps_.begin() + static_cast<ptrdiff_t>(block - std::min<size_t>(block, 1)),
                                 steps_.begin() + static_cast<ptrdiff_t>(last + 1));
    }

    /// The largest share that a disc has earned, judged by the points within `look`; infinity: any.
    static float earned_at(ChunkNeighbours::Surroundings& around, double look, const WideDisc& disc) {
        const auto view = around.around(look);
        return earned_area(view.tile, view.centre, static_cast<float>(view.radius), disc);
    }

    /// The largest share of a site beside its neighbours: a point in the air has a wide cell although they
    /// have narrow ones.
    float most_beside(const Patch& nearest, float area) {
        const float most = kMostShares * share_of_neighbours(nearest);
        return area > most && !fitter_.lies_in_plane_of_others(nearest) ? most : area;
    }

    /// The largest share of a point of a strip that hangs in the air. Its cell reaches across the strip as
    /// far as along it, which is many times the step from one point to the next.
    static float most_of_strip(const Patch& nearest) {
        const float own = std::numbers::pi_v<float> / 2 * nearest.distance2[2];
        return kMostOfStrip * std::max(own, share_of_neighbours(nearest));
    }

    /// The number of points within `times` the reach, divided by that of a sheet as sparse as the site's
    /// neighbourhood; 0 where it is certainly not more than kCrowded.
    float crowding_at(ChunkNeighbours::Surroundings& around, double reach, double times) {
        const auto view = around.around(times * reach);
        if (view.radius < times * reach) return std::numeric_limits<float>::infinity();  // too many to gather
        const double sheet = times * times * static_cast<double>(usual_);
        if (static_cast<double>(view.tile.count) <= kCrowded * sheet) return 0;
        around.within(times * reach, window_);
        return static_cast<float>(static_cast<double>(window_.count) / sheet);
    }

    double leave_out(uint32_t site) {
        surface_.areas[site] = kStrayArea;
        surface_.edges[site].fill(kNoSite);
        return 0;
    }

    /// Takes the window's points that lie nearer to the other plane of a crease than to their own out of the
    /// layer that cuts the cell: the cell reaches to the line where the planes meet, not half-way to them.
    void leave_to_other_sides(const Side& side) {
        const float level = (side.layer.low + side.layer.high) / 2;
        for (const Crease& crease : {side.first, side.second})
            for (size_t i = 0; i < window_.count && crease.distance > 0; ++i) {
                const float away = std::abs(glm::dot(crease.other, window_.offset(i)) - crease.offset);
                if (away < std::abs(heights_[i] - level)) heights_[i] = std::numeric_limits<float>::max();
            }
    }

    const Patch* improve(SurfaceFit& fit, const SurfaceFit& other, const Patch& patch, const Patch& old) {
        if (!(other.deviation < fit.deviation)) return &old;
        fit = other;
        return &patch;
    }

    /// Takes the window around a site. Returns its radius.
    double take_window(ChunkNeighbours::Surroundings& around, double reach) {
        double radius = kWindow * reach;
        for (int tries = 0; tries < 8; ++tries) {
            radius = around.within(radius, window_);
            if (window_.count <= kMostWindow * usual_) break;
            const double share =
                static_cast<double>(kUsualWindow * usual_) / static_cast<double>(window_.count);
            radius = std::max(reach, radius * std::sqrt(share));
        }
        return radius;
    }

    /// Returns the border of a site's surface, if there is one. `spacing`: of the points if the neighbours
    /// fill half a disc.
    static std::optional<SiteLine> border_at(uint32_t site, const glm::vec3& outward,
                                             ChunkNeighbours::Surroundings& around, const SurfaceFit& fit,
                                             float spacing) {
        const auto view = around.around(kBorderLook * spacing);
        const float level = kRoughLevel * std::sqrt(fit.variance) + kFlatLevel * spacing;
        const Rim rim{tangent_frame(fit.normal), outward, spacing, level};
        const auto border = find_border(view.tile, view.centre, rim);
        if (!border) return std::nullopt;
        return SiteLine{site, fit.normal, border->toward, border->distance, border->beyond};
    }

    void connect(uint32_t site, const Patch& nearest, const Patch* wide, const glm::vec3& normal) {
        auto& edges = surface_.edges[site];
        edges.fill(kNoSite);
        const size_t others = nearest.count - 1;
        const size_t far_step =
            std::max<size_t>(1, (others - std::min(others, kNearEdges)) / (kSiteEdges - kNearEdges));
        for (size_t e = 0; e < std::min(kSiteEdges, others); ++e) {
            const size_t rank = e < kNearEdges ? e + 1 : kNearEdges + (e - kNearEdges + 1) * far_step;
            set_edge(edges[e], nearest.index[std::min(rank, others)]);
        }
        if (wide) connect_across(edges, *wide, normal);
        size_t border = 0;
        for (size_t i = 1; i <= others && border < kBorderEdges; ++i) {
            if (!neighbours_.is_halo(nearest.index[i])) continue;
            border_.push_back({site, neighbours_.halo_point(nearest.index[i]), nearest.offset(i)});
            ++border;
        }
    }
    /// Connects the rim of a patch to the surface beyond it. A patch much denser than the surface around it
    /// has no other edges to that surface.
    void connect_rim(uint32_t site, const ChunkNeighbours::Surroundings::View& view, size_t slot) {
        const Tile& tile = view.tile;
        const uint32_t other = tile.index[slot];
        if (neighbours_.is_halo(other))
            border_.push_back({site, neighbours_.halo_point(other),
                               glm::vec3(tile.x[slot], tile.y[slot], tile.z[slot]) - view.centre});
        else
            surface_.edges[site].back() = other;
    }
    void set_edge(uint32_t& edge, uint32_t other) const {
        if (!neighbours_.is_halo(other)) edge = other;
    }
    /// Connects a site to the next scan line, or out of a blob of noise: to the nearest point in each quarter
    /// that is low over the plane.
    void connect_across(SiteEdges& edges, const Patch& wide, const glm::vec3& normal) const {
        const auto nearest = nearest_by_quarter(wide, tangent_frame(normal), kSlope2);
        static_assert(nearest.size() == kSiteEdges - kNearEdges);
        for (size_t quarter = 0; quarter < nearest.size(); ++quarter)
            if (nearest[quarter] < wide.count)
                set_edge(edges[kNearEdges + quarter], wide.index[nearest[quarter]]);
    }

    ChunkNeighbours& neighbours_;
    size_t usual_;  ///< how many neighbours are asked for, the site included
    std::span<const double> steps_;
    ChunkSurface& surface_;
    SurfaceFitter fitter_;
    Patch window_, further_;
    std::vector<float> heights_, distances2_;
    std::vector<uint32_t> apart_;
    std::vector<SideNormal> sides_;
    std::vector<SiteLine> lines_;
    std::vector<CrowdedSite> crowded_;
    std::vector<BorderEdge> border_;
};

/// What single sites found out, in an order that does not depend on threads.
void collect(ChunkSurface& surface) {
    std::sort(surface.apart.begin(), surface.apart.end());
    std::sort(surface.sides.begin(), surface.sides.end(),
              [](const SideNormal& a, const SideNormal& b) { return a.site < b.site; });
    std::sort(surface.lines.begin(), surface.lines.end(),
              [](const SiteLine& a, const SiteLine& b) { return a.site < b.site; });
    std::sort(surface.crowded.begin(), surface.crowded.end(),
              [](const CrowdedSite& a, const CrowdedSite& b) { return a.site < b.site; });
    auto& border = surface.border;
    const auto key = [](const BorderEdge& e) { return std::tie(e.site, e.other.chunk, e.other.index); };
    std::sort(border.begin(), border.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
    border.erase(std::unique(border.begin(), border.end(), same), border.end());
}

}  // namespace

Result<ChunkSurface> estimate_surface(ChunkNeighbours& neighbours, size_t k) {
    ChunkSurface surface;
    const size_t sites = neighbours.site_count();
    surface.normals.assign(sites, glm::vec3(0.0f));
    surface.areas.assign(sites, 0.0f);
    SiteEdges none;
    none.fill(kNoSite);
    surface.edges.assign(sites, none);
    const std::vector<double> steps = median_steps(neighbours);
    tbb::enumerable_thread_specific<SiteEstimator> estimators(
        [&] { return SiteEstimator(neighbours, k + 1, steps, surface); });
    LUCARNE_TRY(neighbours.search(
        k + 1, [&](uint32_t site, const Patch& nearest, bool exact, ChunkNeighbours::Surroundings& around) {
            if (exact) return estimators.local().visit(site, nearest, around);
            estimators.local().give_up(site, nearest, around.certain());
            return 0.0;
        }));
    for (const auto& estimator : estimators) {
        surface.apart.insert(surface.apart.end(), estimator.apart().begin(), estimator.apart().end());
        surface.sides.insert(surface.sides.end(), estimator.sides().begin(), estimator.sides().end());
        surface.lines.insert(surface.lines.end(), estimator.lines().begin(), estimator.lines().end());
        surface.crowded.insert(surface.crowded.end(), estimator.crowded().begin(), estimator.crowded().end());
        surface.border.insert(surface.border.end(), estimator.border().begin(), estimator.border().end());
    }
    collect(surface);
    return surface;
}

}  // namespace lucarne::octree
