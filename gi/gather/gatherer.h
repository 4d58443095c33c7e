#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/device/cl/cl_device.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/gather_point.h"
#include "gi/gather/gather_sky.h"
#include "gi/gather/light_by_direction.h"
#include "gi/gather/light_by_normal.h"
#include "gi/gather/sky_openings.h"
#include "gi/gather/sky_picture.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi {

/// Which light points gather.
enum class Gathered : uint8_t { light_of_surfels, sky, both };

/// Micro-buffers that stay on an OpenCL device, to be lit as often as the light changes.
class MicroBuffers {
 public:
    size_t count() const { return count_; }
    /// How often they were drawn: the same number means the same buffers.
    uint64_t drawing() const { return drawing_; }
    /// Whose buffers these are.
    std::span<const GatherPoint> points() const { return held_; }
    /// Returns what the pixels of all buffers see (gather_point.h), in order of the points. Errors: the
    /// device failed.
    Result<std::vector<uint32_t>> seen() const;
    /// Returns for each point the mean of 1 over the distance of what it sees, 1/m. Errors likewise.
    Result<std::vector<float>> nearness() const;

 private:
    friend class Gatherer;
    ClBuffer points_, seen_, nearness_;
    std::vector<GatherPoint> held_;  ///< whose buffers these are
    std::vector<uint32_t> order_;    ///< numbers of the points in the order in which the device has them
    size_t count_ = 0;
    uint32_t grid_ = 0;
    uint64_t seed_ = 0, tree_ = 0, drawing_ = 0;
};

/// Gathers the light of a tree of surfels at points, on an OpenCL device (gather.cl).
class Gatherer {
 public:
    /// Sends the tree to the device, or lends it to a processor (ClDevice::lend()); null: none. Errors:
    /// device memory.
    Result<void> set_tree(ClDevice& device, const std::shared_ptr<const SurfelTree>& tree);
    /// Sends the light of the tree's slots (pull_light()) to the device, or lends it to a processor. Errors:
    /// device memory.
    Result<void> set_light(ClDevice& device, SharedLight slots);
    /// Sends specular light to the device, which the slots send out beside that of set_light() until it is
    /// replaced. Errors: device memory.
    Result<void> set_lobes(ClDevice& device, const SideLobes& lobes);
    /// Leaves light out of what gather() and shade() find (BrightLight), until set_no_bright() or other light
    /// or another tree comes: of each slot that much, W/(sr m^2), as far as it is far beyond the root of
    /// `reach2`, m^2. Errors: device memory.
    Result<void> set_bright(ClDevice& device, SharedLight slots, float reach2);
    void set_no_bright() { reach2_ = kNoReach; }
    /// Tells the mean radiance that points usually receive, W/(sr m^2), until other light comes: backs of
    /// nodes that are not much brighter are taken for what they are drawn as.
    void set_typical(float radiance) { typical_ = radiance; }
    /// Sends the sky to the device; it shines where there are no surfels. Errors: device memory.
    Result<void> set_sky(ClDevice& device, const GatherSky& sky);
    /// Has each point look for the sky through openings with so many rays of its own as well, until
    /// set_no_openings(), the next call or another tree comes. The openings must live until then. Null:
    /// without. Errors: device memory.
    Result<void> set_openings(ClDevice& device, const SkyOpenings* openings, uint32_t rays);
    void set_no_openings() { openings_ = nullptr; }
    /// Sets for each point the mean radiance that it receives, weighted by the cosine, W/(sr m^2) (times pi:
    /// irradiance), and in w the share of directions in which there is nothing. About side^2 rays are cast
    /// from each point; `seed` selects them. If `stop`
    /// becomes true the rest is left out. `done` is told how many points are finished each time some are.
    /// `fill`: what the nodes of the tree cover.
    /// Errors: the device failed.
    Result<void> gather(ClDevice& device, Gathered what, std::span<const GatherPoint> points, uint32_t side,
                        uint64_t seed, std::span<glm::vec4> results, const std::atomic<bool>* stop = nullptr,
                        const std::function<void(size_t)>& done = {}, Fill fill = Fill::rays);
    /// Draws micro-buffers for points that gather evenly from their half spaces, and keeps them in `buffers`;
    /// does nothing if it has drawn these of the same tree. Arguments and errors as for gather(). Use a
    /// MicroBuffers with one gatherer only.
    Result<void> see(ClDevice& device, std::span<const GatherPoint> points, uint32_t side, uint64_t seed,
                     MicroBuffers& buffers, const std::atomic<bool>* stop = nullptr);
    /// Computes the light that reaches the points of `buffers`, which see() has drawn. If `stop` becomes true
    /// the rest is left dark. Errors: the device failed.
    Result<std::vector<LightByNormal>> shade(ClDevice& device, Gathered what, const MicroBuffers& buffers,
                                             const std::atomic<bool>* stop = nullptr);
    /// Does the same by direction.
    Result<std::vector<LightByDirection>> shade_by_direction(ClDevice& device, Gathered what,
                                                             const MicroBuffers& buffers,
                                                             const std::atomic<bool>* stop = nullptr);

 private:
    /// Lights buffers by a kernel that makes a `Light` of each.
    template <class Light>
    Result<std::vector<Light>> light_buffers(ClDevice& device, const char* kernel, Gathered what,
                                             const MicroBuffers& buffers, const std::atomic<bool>* stop);
    struct Asked {
        uint32_t lit, glossy;
        SkyPicture sky;
        uint32_t open;  ///< spheres at openings
    };
    /// Returns what a kernel needs to know of the light that is asked for.
    Asked asked(Gathered what) const;
    /// Sends to the device with what density the points look for the sky through openings.
    Result<void> send_densities(ClDevice& device, std::span<const GatherPoint> points, uint32_t grid);
    /// Calls visit(i, direction, light) for the rays of these points that meet the sky
    /// (SkyOpenings::each_ray()).
    void each_sky_ray(std::span<const GatherPoint> points,
                      const std::function<void(size_t, const glm::vec3&, const glm::vec3&)>& visit) const;
    /// Sends points in the order of their groups, and where these begin.
    Result<void> send_points(ClDevice& device, std::vector<GatherPoint> points,
                             std::span<const uint32_t> first, ClBuffer& to);
    Result<void> make_rays(ClDevice& device, uint32_t grid, uint64_t seed);

    static constexpr float kNoReach = -1;

    ClBuffer nodes_, light_, bright_, lobe_light_, lobe_directions_, sky_texels_, spheres_, densities_of_,
        points_, groups_, results_, rays_;
    SkyPicture sky_{};
    bool empty_ = true, glossy_ = false;
    float reach2_ = kNoReach;
    float typical_ = 0;
    float reach_ = 0;  ///< how far away what points see usually is, m
    const SkyOpenings* openings_ = nullptr;
    uint32_t rays_to_sky_ = 0;
    float rays_over_buffer_ = 0;    ///< rays_to_sky_ over the rays of a buffer
    std::vector<float> densities_;  ///< of the points of one launch
    uint32_t grid_ = 0;
    uint64_t seed_ = 0;
    uint64_t tree_ = 0;  ///< number of the tree
};

}  // namespace lucarne::gi
