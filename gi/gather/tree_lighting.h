#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/changes.h"
#include "gi/gather/bright_light.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/gatherer.h"
#include "gi/gather/lit_tree.h"
#include "gi/gather/photons.h"
#include "gi/gather/radiosity.h"
#include "gi/gather/sky_openings.h"
#include "gi/gather/traced_tree.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/light_gbuffers.h"

namespace lucarne::gi {

/// What engines that gather share: the tree of the light cut, its light, and the light of the lights. Kept as
/// long as nothing but the camera changes. Lights shine by their views. The sky shines where micro-buffers
/// are empty; only what is much brighter than the rest of it gets views as well.
class TreeLighting {
 public:
    void update(const Changes& changes);
    /// Opens OpenCL and sends materials and sky to the devices. `engine` names who asks. Errors: cuts are
    /// missing, no OpenCL, device memory.
    Result<void> prepare(Frame& frame, std::string_view engine);
    /// Chooses the views of the lights. Call first in every frame.
    void begin(Frame& frame);
    /// Brings the tree up to date. Errors: a device failed.
    Result<void> make_tree(Frame& frame);
    /// Brings the light that surfels send out up to date, after so many reflections (`settings`, whose seed
    /// may differ from frame to frame), and gives it to the gatherer. Errors: a device failed.
    Result<void> make_light(Frame& frame, const Radiosity::Settings& settings,
                            LightPoints points = LightPoints::radiosity);
    /// Finds the light that is bright for some points, which gather `what` first, and has the gatherer leave
    /// it out (BrightLight::find()). Bright light is taken from that of make_light(); after
    /// set_irradiance(own = true), from the surfels' own light. Returns none if there is none. Errors:
    /// Embree's, a device failed.
    Result<const BrightLight*> find_bright(Frame& frame, std::span<const GatherPoint> pilots, Gathered what,
                                           uint64_t seed);
    /// Finds the openings to the sky that some points see (SkyOpenings::find()), for the gatherer; empty if
    /// there are none. All frames of a view have those of the first: the mean of its light does not depend
    /// on them. Errors: Embree's.
    Result<const SkyOpenings*> find_openings(Frame& frame, std::span<const GatherPoint> pilots,
                                             uint64_t seed);
    /// Gives the gatherer other light: the surfels' own (if `own`), and what slots reflect of this
    /// irradiance, W/m^2, by side (twice the slot, and one more for the back). make_light() has to come
    /// first. Errors: a device failed.
    Result<void> set_irradiance(std::span<const glm::vec3> irradiance, bool own);
    /// Adds emission, background and the first reflection of the lights to the picture; the even part of the
    /// sky is left out. Errors: a device failed.
    Result<void> add_direct(Frame& frame);

    /// Number of the light that make_light() has made: the same means the same light of surfels and sky.
    uint64_t light_number() const { return light_number_; }
    /// Whether micro-buffers see light where they are empty.
    bool has_sky() const { return !sky_.texels.empty(); }
    ClDevice& opencl() { return *opencl_; }
    Gatherer& gatherer() { return gatherer_; }
    const LitTree& lit() const { return lit_; }
    const Radiosity& radiosity() const { return radiosity_; }

 private:
    /// What the light of the tree depends on.
    struct Basis {
        SceneRevisions scene;
        LightCutRevisions cuts;
        std::vector<Light> lights;  ///< of the views: samples of lights with a size differ in every frame
        uint64_t frame = 0;         ///< under a sky, which every frame samples anew
        bool operator==(const Basis&) const = default;
    };

    /// Sets the light that surfels send out evenly, and `lobes_`. Errors: a device failed.
    Result<void> exchange(Frame& frame, Radiosity::Settings settings, LightPoints points,
                          std::vector<SideLight>& light);
    /// Makes the tree and traced_. Errors: Embree's, a device failed.
    Result<void> trace_tree(Frame& frame);
    void drop_openings();
    /// Gives the gatherer this light.
    Result<void> set_slots(SharedLight slots, const SideLobes& lobes);

    ClDevice* opencl_ = nullptr;  ///< of the frame's device
    Gatherer gatherer_;
    Buffer materials_;
    Sky background_;
    GatherSky sky_;
    SkyDirections bright_;
    std::vector<LightView> views_;
    LightGBuffers light_gbuffers_;
    LitTree lit_;
    Radiosity radiosity_;
    SceneRevisions scene_;  ///< of the frame that is drawn
    LightCutRevisions cuts_;
    std::optional<uint64_t> sky_of_;    ///< revision of the environment that the sky is made from
    std::optional<TracedTree> traced_;  ///< of the tree, once something asks for it
    std::optional<Photons> photons_;    ///< likewise
    BrightLight bright_light_;          ///< for the last picture
    SkyOpenings openings_;              ///< for the frames of openings_of_
    std::optional<std::pair<CameraView, uint64_t>> openings_of_;  ///< view, revision of the settings
    std::optional<uint64_t> tree_of_;  ///< revision of the light cut that the tree is made from
    std::optional<Basis> light_of_;
    uint64_t light_number_ = 0;
    SharedLight slots_;      ///< the light of make_light()
    SideLobes lobes_;        ///< by slot, that belong to it
    bool replaced_ = false;  ///< the gatherer has other light
    std::vector<SideLight> own_slots_,
        reflecting_;  ///< the surfels' own light, and their reflectances, pulled
    std::optional<std::pair<uint64_t, uint64_t>> reflecting_of_;  ///< revisions of light cut and materials
};

}  // namespace lucarne::gi
