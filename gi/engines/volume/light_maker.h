#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/changes.h"
#include "gi/engines/volume/first_bounce.h"
#include "gi/engines/volume/focus.h"
#include "gi/engines/volume/options.h"
#include "gi/engines/volume/propagation.h"
#include "gi/engines/volume/space.h"
#include "gi/engines/volume/sweep.h"
#include "gi/gather/gather_sky.h"
#include "gi/gl_frame.h"
#include "gi/lighting/lit_surfels.h"
#include "gi/steps.h"

namespace lucarne::gi::volume {

/// What the light in a volume is made from. Equal bases give equal light.
struct Basis {
    SceneRevisions scene;
    glm::dvec3 origin{0.0};  ///< Frame::origin
    Bounds bounds;           ///< Frame::bounds
    LightCutRevisions cuts;
    std::vector<Light> lights;  ///< of the views: samples of lights with a size differ in every frame
    uint64_t frame = 0;         ///< Frame::index, which turns the directions of sweeps
    Focus focus;
    bool operator==(const Basis&) const = default;
};

/// Light at the faces of the voxels, which pixels read.
struct VolumeLight {
    std::optional<Basis> basis;    ///< none: there is no light yet
    std::vector<LitLevel> levels;  ///< the coarsest first; the light is of the bounces that were asked for
};

/// Makes a VolumeLight, step by step: divides the surfels among voxels, lights them, and carries the light
/// from face to face, bounce by bounce. What did not change since the last time is not made again.
class LightMaker {
 public:
    /// What the steps read beside the frame.
    struct Inputs {
        const std::vector<LightView>&
            views;  ///< of the lights, and of what is too bright in the sky for sweeps
        LightGBuffers& gbuffers;
        const GatherSky& sky;  ///< what else shines in the sky
    };

    /// Starts again. Levels that are there are kept as far as their basis is the same.
    void begin(Basis basis, const EngineSettings& settings);
    void stop() { runner_.cancel(); }
    bool running() const { return runner_.running(); }
    /// Whether what is being made may go on in a frame with another basis: lights may move meanwhile.
    bool goes_on(const Basis& now) const;
    /// Takes as many steps as the budget allows and until the frame is given up. Sets `target` when the last
    /// one is done. Errors: device memory, a shader that fails, discs that touch too many voxels.
    Result<void> run(Frame& frame, const Inputs& inputs, const StepBudget& budget, VolumeLight& target);

    size_t lit_faces() const { return lit_faces_; }
    /// The share of the light sent out with transport sh that had not arrived after the last iterations.
    double under_way() const { return under_way_; }

 private:
    struct Work {
        Frame& frame;
        const Inputs& inputs;
    };
    /// What the surfels are, and the coarsest voxels are made from.
    struct SpaceBasis {
        uint64_t light_cut = 0, bounds = 0;
        uint32_t voxels = 0;
        bool operator==(const SpaceBasis&) const = default;
    };
    /// Voxels and their light.
    struct Level {
        std::shared_ptr<Space> space;
        std::optional<VoxelMaker> voxel_maker;  ///< while the space is being made
        std::optional<FaceMaker> face_maker;
        std::optional<FirstBounce> first_bounce;
        bool made = false;            ///< the space is whole
        std::optional<Basis> own_of;  ///< what `own` was made from
        std::vector<glm::vec3> own;   ///< by face: radiance before any bounce but of the sky, W/(sr m^2)
        std::vector<glm::vec3> reflectances;  ///< by face, 1/sr
        std::vector<glm::vec3> first_light;   ///< by face: irradiance by the first bounce, W/m^2
        std::vector<glm::vec3>
            from_outside;                ///< by face: that part of it which comes from beyond the next level
        std::vector<glm::vec3> sources;  ///< by face: radiance that the next bounce carries
        std::vector<glm::vec3> shown;    ///< by face: irradiance that pixels show, W/m^2
    };

    Result<StepResult> take_surfels(Work& work);
    Result<StepResult> divide(Work& work, size_t level);
    Result<StepResult> find_faces(Work& work, size_t level);
    Result<StepResult> light_surfels(Work& work);
    Result<StepResult> light_faces(Work& work);
    void begin_sweep(Directions directions, const Sweeper::Outside& outside, bool dark);
    Result<StepResult> sweep_sky(Work& work);
    Result<StepResult> gather_first(Work& work, size_t level);
    Result<StepResult> sweep_bounce(Work& work, uint32_t bounce);
    Result<StepResult> propagate_bounce(Work& work, uint32_t bounce);
    void add_bounce(Level& level, uint32_t bounce, std::span<const glm::vec3> irradiance) const;
    Directions directions(uint32_t bounce, uint32_t count) const;

    StepRunner<Work> runner_;
    Basis basis_;
    uint32_t first_shown_ = 1, last_ = 1;  ///< the bounces that pixels show; none if the last one is 0
    bool shows_sky_ = true;                ///< pixels show the sky's direct light
    uint32_t sweep_count_ = 64, voxel_count_ = 64;
    uint64_t seed_ = 0;
    Transport transport_ = Transport::sweeps;
    uint32_t iterations_ = 64;

    LitSurfels surfels_;
    std::deque<Level> levels_;  ///< the coarsest first
    std::optional<Sweeper> sweeper_;
    std::optional<Propagation> propagation_;
    std::optional<SpaceBasis> surfels_of_;
    Focus focus_;                                  ///< of the levels that are there
    std::optional<Basis> surfels_lit_, first_of_;  ///< what light of surfels and first_light were made from
    size_t views_done_ = 0;
    bool sweeping_ = false;  ///< the present step has begun
    size_t lit_faces_ = 0;
    double sent_ = 0;  ///< luminance of the flux that faces sent out in the present bounce
    double under_way_ = 0;
};

}  // namespace lucarne::gi::volume
