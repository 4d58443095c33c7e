#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/interpolation.h"
#include "gi/engines/paths/point_sky.h"
#include "gi/lighting/lobe_albedo.h"
#include "gi/lighting/lobe_cells.h"
#include "gi/shared/brdf.h"

namespace lucarne::gi::paths {

/// Light that arrives at gathering points, sorted by direction, for what glossy surfaces reflect of it. Yue
/// et al. 2007 keep 128 directions; here these are the cells of an octahedral map (LobeCells).
class ArrivingLight {
 public:
    explicit ArrivingLight(std::shared_ptr<const PathsBake> bake);
    /// Takes the radiosity of all groups, W/m^2 (empty: they are dark), what lobes send along each ray
    /// besides (Relight::lobe_light(); may be empty), and the light of a sky (null: none), and notes which
    /// lobes are asked for.
    void set(std::span<const glm::vec3> radiosity, std::span<const glm::vec3> of_lobes, const PointSky* sky,
             std::span<const Material> materials);

    /// Returns the radiance that a surface reflects by its lobe in the direction `to`. `about`: its gathering
    /// points, whose mean irradiance is `irradiance`, W/m^2. The material must be one of set().
    glm::vec3 reflected(std::span<const PointShare> about, const glm::vec3& irradiance,
                        const Reflectance& surface, const glm::vec3& normal, const glm::vec3& to) const;

 private:
    std::shared_ptr<const PathsBake> bake_;
    std::vector<uint8_t> cell_of_;  ///< of each ray of each point
    std::vector<uint8_t> rays_in_;  ///< of each cell of each point
    std::vector<glm::vec3> light_;  ///< of each cell of each point: sum of the radiosities that its rays meet
    LobeCells cells_;
    LobeAlbedos albedos_;
};

}  // namespace lucarne::gi::paths
