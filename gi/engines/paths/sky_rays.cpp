#include "gi/engines/paths/sky_rays.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/engines/paths/interpolation.h"
#include "gi/lighting/area_points.h"
#include "gi/lighting/sky_directions.h"
#include "gi/lighting/sky_grid.h"
#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

/// Points disagree if their standard deviation exceeds this share of their mean, and more than this share of
/// their rays see the sky: where few do, the deviation is that of the rays, and rays of pixels are noisier.
constexpr float kDisagree = 0.25f, kFewestOpen = 0.1f;
/// The cosine of the turn from the normals of a place's points below which they are none of its surface.
constexpr float kLeastAlike = 0.88f;
constexpr uint32_t kSkyRays = 64;  ///< of a place
/// The share of rays drawn by the cosine alone: the points may have missed what a pixel sees.
constexpr double kAnywhere = 0.5;

/// A density of directions: in proportion to the light by which points see the cells of sky_grid.h, or by the
/// cosine.
class Guide {
 public:
    Guide(const PointSky& sky, std::span<const PointShare> about, const glm::vec3& normal)
        : normal_(normal), weights_(kSkyCells, 0.0f) {
        for (const PointShare& share : about) {
            for (const uint16_t cell : sky.cells(share.point)) {
                const float weight = share.share * sky.luminances()[cell];
                if (!(weight > 0)) continue;
                if (weights_[cell] == 0) cells_.push_back(cell);
                weights_[cell] += weight;
            }
        }
        for (const uint32_t cell : cells_) sums_.push_back(total_ += weights_[cell]);
    }
    bool empty() const { return cells_.empty(); }  ///< then all directions are drawn by the cosine

    /// Returns the direction that belongs to a point of the unit square.
    glm::vec3 direction(glm::dvec2 square) const {
        if (empty()) return cosine_direction(normal_, square);
        if (square.y < kAnywhere) return cosine_direction(normal_, {square.x, square.y / kAnywhere});
        const double at = (square.y - kAnywhere) / (1 - kAnywhere) * total_;
        const auto found = static_cast<size_t>(std::ranges::upper_bound(sums_, at) - sums_.begin());
        const size_t i = std::min(found, cells_.size() - 1);
        const double begin = i > 0 ? sums_[i - 1] : 0;
        const double within = std::clamp((at - begin) / (sums_[i] - begin), 0.0, 1.0 - 1e-12);
        return sky_direction(cells_[i], square.x, within);
    }
    /// Returns its density, 1/sr.
    float density(const glm::vec3& direction) const {
        const double cosine = std::max(glm::dot(normal_, direction), 0.0f);
        if (empty()) return static_cast<float>(cosine / M_PI);
        const double guided = weights_[sky_cell(direction)] / total_ * kSkyCells / (4 * M_PI);
        return static_cast<float>((1 - kAnywhere) * guided + kAnywhere * cosine / M_PI);
    }

 private:
    glm::vec3 normal_;
    std::vector<float> weights_;   ///< of each cell of the grid
    std::vector<uint32_t> cells_;  ///< those with a weight
    std::vector<double> sums_;     ///< running sums of their weights
    double total_ = 0;
};

}  // namespace

bool SkyRays::are_unsure(const SurfacePoint& place, std::span<const PointShare> about) const {
    if (about.size() <= 1) return true;  // none, or the nearest of those beyond their reach
    float mean = 0, square = 0, open = 0, turn = 0;
    for (const PointShare& share : about) {
        const float light = luminance(at_points_[share.point]);
        mean += share.share * light;
        square += share.share * light * light;
        open += share.share * static_cast<float>(point_sky_.cells(share.point).size());
        turn += share.share * glm::dot(place.normal, point_sky_.normal(share.point));
    }
    if (turn < kLeastAlike) return true;
    return square - mean * mean > kDisagree * kDisagree * mean * mean &&
           open > kFewestOpen * static_cast<float>(point_sky_.rays_a_point());
}

glm::vec3 SkyRays::correction(const SurfacePoint& place, const glm::vec3& start,
                              std::span<const PointShare> about, uint64_t key) const {
    if (!are_unsure(place, about)) return glm::vec3(0.0f);
    const Guide guide(point_sky_, about, place.normal);
    if (guide.empty() && !about.empty()) return glm::vec3(0.0f);
    Random random(key);
    glm::dvec2 shift;
    shift.x = random.uniform();
    shift.y = random.uniform();
    glm::vec3 sum(0.0f);
    for (uint32_t i = 0; i < kSkyRays; ++i) {
        const glm::vec3 direction = guide.direction(lattice_point(i, kSkyRays, shift));
        const float cosine = glm::dot(place.normal, direction);
        if (!(cosine > 0)) continue;
        const glm::vec3 radiance = sky_.radiance(direction);
        if (radiance != glm::vec3(0.0f) && !tracer_.occluded_along(start, direction))
            sum += radiance * (cosine / guide.density(direction));
    }
    return sum / static_cast<float>(kSkyRays) - irradiance_of(about, at_points_);
}

}  // namespace lucarne::gi::paths
