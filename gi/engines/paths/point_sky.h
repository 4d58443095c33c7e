#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/gather/gather_sky.h"

namespace lucarne::gi::paths {

/// The sky as gathering points see it: by their rays that leave the scene.
class PointSky {
 public:
    explicit PointSky(std::shared_ptr<const PathsBake> bake);

    /// Sets which sky shines. `sky` must outlive this, or the next call.
    void set(const GatherSky& sky);
    /// The irradiance of each point by that sky, W/m^2.
    std::span<const glm::vec3> irradiance() const { return irradiance_; }
    /// Returns what the `ray`th of a point's rays that leave the scene sees, W/(sr m^2).
    glm::vec3 radiance(size_t point, size_t ray) const;
    /// About how bright the sky is in each cell of gi/lighting/sky_grid.h, W/(sr m^2).
    std::span<const float> luminances() const { return luminances_; }
    uint32_t rays_a_point() const { return bake_->paths.rays_a_point; }
    const glm::vec3& normal(size_t point) const { return bake_->paths.points[point].normal; }
    /// The cells of gi/lighting/sky_grid.h to which these rays go.
    std::span<const uint16_t> cells(size_t point) const {
        return std::span(cells_).subspan(first_[point], first_[point + 1] - first_[point]);
    }

 private:
    std::shared_ptr<const PathsBake> bake_;
    std::vector<uint32_t> first_;  ///< of each point: of its rays that leave; and their end
    std::vector<uint32_t> open_;   ///< their directions, as octahedral codes
    std::vector<uint16_t> cells_;  ///< likewise
    const GatherSky* sky_ = nullptr;
    std::vector<float> luminances_;
    std::vector<glm::vec3> irradiance_;
};

}  // namespace lucarne::gi::paths
