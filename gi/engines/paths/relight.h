#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/group_lobes.h"
#include "gi/engines/paths/options.h"
#include "gi/gather/gather_sky.h"
#include "gi/shared/material.h"

namespace lucarne::gi::paths {

/// Computes the light at gathering points from that at entry points, without any ray. Every sum pulls its
/// terms in a fixed order, so the result is the same on every run and any number of threads.
///
/// Light is radiosity, W/m^2: what leaves a surface in all directions, evenly. What lobes reflect of lamps
/// goes where the lobe of each group does if a gathering ray meets it; on further bounces, and of other
/// light, it is spread evenly, too.
class Relight {
 public:
    explicit Relight(std::shared_ptr<const PathsBake> bake) : bake_(std::move(bake)) {}
    const PathsBake& bake() const { return *bake_; }
    const std::shared_ptr<const PathsBake>& shared_bake() const { return bake_; }

    /// Which bounces count: the first and the last one, from 1.
    struct Bounces {
        uint32_t first = 1, last = 1;
    };
    /// Sets what entry points send out: emission, and what they reflect of `irradiance`, W/m^2 (one an entry
    /// point), and of a sky (null: none; the part of it that few rays find) by the links that leave the
    /// scene. `materials`: as many as a surfel can refer to (device_materials()). `directions`: from
    /// which the irradiance arrives (LampLight), for lobes; empty: as if it were even.
    void enter(std::span<const Material> materials, std::span<const glm::vec3> irradiance,
               const GatherSky* sky, std::span<const glm::vec3> directions = {});
    /// Lets that light bounce. Photons have no more than four bounces.
    void bounce(const Bounces& bounces, Transport transport);
    /// Returns the irradiance at each gathering point, W/m^2, by the light of these bounces.
    std::vector<glm::vec3> gather() const;
    /// The radiosity of each group by these bounces, W/m^2.
    std::span<const glm::vec3> radiosity() const { return sum_; }
    /// What reaches each gathering ray besides, of lamps by the lobes of its group, W/m^2: the radiosity of a
    /// diffuse surface that looks as bright along this ray. Empty: no lobe shines.
    std::span<const glm::vec3> lobe_light() const { return lobe_light_; }

 private:
    std::vector<glm::vec3> light_of_sky(const GatherSky& sky) const;
    template <class Light>
    void coarsen(std::vector<Light>& light) const;
    void shine_by_lobes();
    void follow_links(const std::vector<glm::vec3>& from, std::vector<glm::vec3>& to) const;
    void follow_photons(uint32_t vertex, std::vector<glm::vec3>& to);
    void make_photon_index();

    std::shared_ptr<const PathsBake> bake_;
    std::vector<glm::vec3> energies_;      ///< of each entry point: radiosity, then of its photon, W
    std::vector<glm::vec3> first_;         ///< radiosity of each leaf without any bounce
    std::vector<glm::vec3> reflectances_;  ///< of each leaf
    std::vector<LampLobe> lobes_;          ///< of each leaf; empty: there are none
    std::vector<glm::vec3> by_lobes_;      ///< their part of first_
    std::vector<glm::vec3> lobe_light_;    ///< of each gathering ray
    std::vector<glm::vec3> sum_;           ///< radiosity of each group
    /// The photons of each group from which links start (the photon index map of the paper): for each vertex
    /// after the first, where those of each begin, and the numbers of their entry points.
    struct PhotonIndex {
        std::vector<uint32_t> first, entries;
    };
    std::vector<PhotonIndex> index_;
    std::vector<float> areas_;  ///< of these groups, m^2
};

}  // namespace lucarne::gi::paths
