#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/native/moved_light.h"

namespace lucarne::gi::paths {

/// The light of gathering points at other places: what their rays met is seen from there. Near a patch of
/// sun, and on the reveal of a window, light changes by much from one point to the next, and pixels see one
/// end of it. Cosines and distances are those of the other place (as of irradiance gradients, Ward & Heckbert
/// 1992, but not linear); what hides one from the other is not.
class MovedRays {
 public:
    explicit MovedRays(std::shared_ptr<const PathsBake> bake);
    /// Takes the radiosity of all groups, W/m^2, and what lobes send along each ray besides
    /// (Relight::lobe_light(); may be empty).
    void set(std::span<const glm::vec3> radiosity, std::span<const glm::vec3> of_lobes = {});
    /// Returns how many times as much light arrives at a place as at its gathering points in their mean.
    /// Even light is the same everywhere. `at`: where its rays start, in the bake's coordinates; in a corner
    /// that is before the wall that hides the rim of a disc. Thread-safe.
    float factor(const glm::vec3& at, const glm::vec3& normal, std::span<const PointShare> about) const;

 private:
    /// The rays of a point, and their light.
    struct Rays {
        std::vector<native::RayBlock> blocks;
        float light = 0;  ///< mean luminance of the radiosities that they meet, W/m^2
    };
    std::span<const uint32_t> groups_of(uint32_t point) const;
    glm::vec3 clear_of_walls(const glm::vec3& at, std::span<const PointShare> about) const;
    void make(uint32_t point, Rays& rays) const;
    void set_light(uint32_t point, Rays& rays) const;
    const Rays& rays_of(uint32_t point, Rays& own) const;

    std::shared_ptr<const PathsBake> bake_;
    std::vector<float> light_;     ///< luminance of the radiosity of each group; then darkness
    std::vector<float> of_lobes_;  ///< luminance of what lobes send along each ray; empty: nothing
    /// The rays of points that pictures have shown, made when they are first asked for.
    struct Kept {
        std::once_flag once;
        Rays rays;
    };
    mutable std::unique_ptr<Kept[]> kept_;
    mutable std::atomic<size_t> count_ = 0;
};

}  // namespace lucarne::gi::paths
