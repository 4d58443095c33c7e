#include "octree/normals/chunk_surface.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <tuple>

#include <tbb/enumerable_thread_specific.h>

#include "io/core/parallel.h"
#include "octree/normals/surface_sample.h"

namespace lucarne::octree {
namespace {

constexpr size_t kNearEdges = 4;  ///< of kSiteEdges; the others are spread over the rest of the neighbourhood
constexpr size_t kRimNeighbours = 16;  ///< asked for in a round, beyond the known ones
constexpr int kRimRounds = 6;
constexpr size_t kBorderEdges = 2;  ///< a site, to the nearest points of other chunks

class SurfaceEstimator {
 public:
    SurfaceEstimator(ChunkNeighbours& neighbours, size_t area_neighbours)
        : neighbours_(neighbours), area_count_(area_neighbours + 1) {
        const size_t sites = neighbours.site_count();
        surface_.normals.assign(sites, glm::vec3(0.0f));
        surface_.areas.assign(sites, 0.0f);
        deviations_.assign(sites, kNoPlane);
        SiteEdges none;
        none.fill(kNoSite);
        surface_.edges.assign(sites, none);
    }

    Result<void> estimate(std::span<const uint32_t> sites, size_t k) {
        return neighbours_.search(sites, k + 1,
                                  [&](uint32_t site, std::span<const Neighbour> nearest, bool exact,
                                      const ChunkNeighbours::Surroundings& around) {
                                      return exact ? visit(site, nearest, k + 1, around) : 0.0;
                                  });
    }
    std::vector<uint32_t> uncertain() const {
        std::vector<uint32_t> sites;
        for (uint32_t i = 0; i < deviations_.size(); ++i)
            if (deviations_[i] > kGoodDeviation && deviations_[i] < kNoPlane) sites.push_back(i);
        return sites;
    }
    ChunkSurface take() {
        for (size_t i = 0; i < deviations_.size(); ++i)
            if (deviations_[i] > kPoorDeviation) surface_.normals[i] = glm::vec3(0.0f);
        std::sort(surface_.apart.begin(), surface_.apart.end());
        auto& border = surface_.border;
        const auto key = [](const BorderEdge& e) { return std::tie(e.site, e.other.chunk, e.other.index); };
        std::sort(border.begin(), border.end(),
                  [&](const auto& a, const auto& b) { return key(a) < key(b); });
        const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
        border.erase(std::unique(border.begin(), border.end(), same), border.end());
        return std::move(surface_);
    }

 private:
    /// 0, or the radius that must be known around the site first.
    double visit(uint32_t site, std::span<const Neighbour> nearest, size_t asked,
                 const ChunkNeighbours::Surroundings& around) {
        std::array<glm::vec3, kMostSampled> offsets;
        const glm::dvec3 at = neighbours_.position(site);
        for (size_t i = 0; i < nearest.size(); ++i)
            offsets[i] = glm::vec3(neighbours_.position(nearest[i].index) - at);
        auto sample = sample_surface(std::span(offsets).first(nearest.size()), area_count_,
                                     nearest.size() < asked, fitters_.local());
        if (sample.deviation >= kNoPlane) {  // out in the air, whatever fewer neighbours said
            deviations_[site] = kNoPlane;
            surface_.areas[site] = sample.area;
            return 0;
        }
        if (!(sample.deviation < deviations_[site])) return 0;
        if (sample.rim) {
            if (!around.knows(sample.rim->widest_search())) return sample.rim->widest_search();
            cut_further(*sample.rim, around);
            if (sample.apart && !sample.rim->closed()) {
                deviations_[site] = kNoPlane;
                surface_.areas[site] = kStrayArea;
                return 0;
            }
            sample.area = sample.rim->area_at_rim();
        }
        if (sample.apart) {
            const std::lock_guard lock(mutex_);
            surface_.apart.push_back(site);
        }
        deviations_[site] = sample.deviation;
        surface_.normals[site] = sample.normal;
        surface_.areas[site] = sample.area;
        connect(site, nearest, offsets);
        return 0;
    }

    /// The nearest that a cell wants are often more of the dense patch, each of which cuts off but little: in
    /// rounds, so that those cut off by others are wanted no longer.
    void cut_further(ShareCell& cell, const ChunkNeighbours::Surroundings& around) const {
        std::array<Neighbour, kRimNeighbours> further;
        for (int round = 0; round < kRimRounds && cell.open(); ++round) {
            const size_t found = around.nearest(
                std::min(cell.widest_search(), cell.widest_cut()),
                [&](const glm::vec3& offset) { return cell.wants(offset); }, further);
            for (size_t i = 0; i < found; ++i) cell.cut(around.offset(further[i].index));
            if (found < kRimNeighbours) break;
        }
    }

    void connect(uint32_t site, std::span<const Neighbour> nearest, std::span<const glm::vec3> offsets) {
        auto& edges = surface_.edges[site];
        edges.fill(kNoSite);
        const size_t others = nearest.size() - 1;
        for (size_t e = 0; e < std::min(kSiteEdges, others); ++e) {
            const size_t far_step =
                std::max<size_t>(1, (others - std::min(others, kNearEdges)) / (kSiteEdges - kNearEdges));
            const size_t rank = e < kNearEdges ? e + 1 : kNearEdges + (e - kNearEdges + 1) * far_step;
            const uint32_t other = nearest[std::min(rank, others)].index;
            if (!neighbours_.is_halo(other)) edges[e] = other;
        }
        size_t border = 0;
        for (size_t i = 1; i <= others && border < kBorderEdges; ++i) {
            if (!neighbours_.is_halo(nearest[i].index)) continue;
            const std::lock_guard lock(mutex_);
            surface_.border.push_back({site, neighbours_.halo_point(nearest[i].index), offsets[i]});
            ++border;
        }
    }

    ChunkNeighbours& neighbours_;
    size_t area_count_;  ///< the site included
    ChunkSurface surface_;
    std::vector<float> deviations_;  ///< kNoPlane: not known, or known to have none
    tbb::enumerable_thread_specific<PlaneFitter> fitters_;
    std::mutex mutex_;
};

}  // namespace

Result<ChunkSurface> estimate_surface(ChunkNeighbours& neighbours, size_t k) {
    SurfaceEstimator estimator(neighbours, k);
    std::vector<uint32_t> sites(neighbours.site_count());
    std::iota(sites.begin(), sites.end(), 0u);
    LUCARNE_TRY(estimator.estimate(sites, k));
    LUCARNE_TRY(estimator.estimate(estimator.uncertain(), std::min(4 * k, kMostSampled - 1)));
    return estimator.take();
}

}  // namespace lucarne::octree
