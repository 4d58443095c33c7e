#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gi/engines/vpl/lighting.h"
#include "gi/engines/vpl/redistribution/redistribution.h"
#include "gi/engines/vpl/seeding/light_seeding.h"
#include "gi/engines/vpl/view_importance/view_importance.h"
#include "gi/frame.h"
#include "gi/lighting/sky_directions.h"
#include "gi/steps.h"

namespace lucarne::gi::vpl {

/// Makes a Lighting, step by step: it places VPLs on the surfaces that the lights see, draws their shadow
/// maps, redistributes the VPLs for the next bounce, and so on. A picture that must not wait for all of it
/// takes some steps in each frame, and shows earlier light meanwhile. Until the last step the light cut must
/// stay the same, and all of the basis but lights, environment and camera.
class LightingMaker {
 public:
    /// What the steps read beside the frame.
    struct Inputs {
        const Basis& now;          ///< of the frame
        const Buffer& materials;   ///< of upload_materials()
        const SkyDirections& sky;  ///< of the frame's environment, none of it favoured
        LightGBuffers& light_gbuffers;
        uint64_t light_index;  ///< Frame::index by which lights with a size are sampled
        /// Takes small steps, of a few hundredths of a second on two cores.
        bool small_steps = false;
        /// If set, called when a bounce has its VPLs and maps. If all bounces share an atlas
        /// (keeps_bounces()), the next bounce overwrites it.
        std::function<Result<void>(uint32_t bounce)> made;
    };

    /// Starts again.
    void begin(Basis basis);
    void stop() { runner_.cancel(); }
    bool running() const { return runner_.running(); }
    /// Whether what is being made may go on in a frame of another basis.
    bool goes_on(const Basis& now) const;

    /// Takes as many steps as the budget allows and until the frame is given up. `target` keeps what earlier
    /// steps made; it is whole when this is not running() any more. Errors: no device memory, a shader that
    /// fails.
    Result<void> run(Frame& frame, const Inputs& inputs, const StepBudget& budget, Lighting& target);

    /// Decodes the casters and measures what matters to the camera, unless that was done for the same basis.
    Result<void> look(Frame& frame, const Inputs& inputs, const Basis& basis);
    /// The camera for which look() last measured importance.
    const CameraView& looked_from() const { return looked_.camera; }
    /// Whether a camera still sees about what it saw then.
    bool serves(const CameraView& camera) const { return view_importance_.serves(camera); }
    /// The directions of the sky, those favoured that reach what the camera saw then.
    const SkyDirections& sky() const { return sky_; }
    /// How much light from each cell of the sky's grid reaches what the camera saw then; empty: unknown.
    const std::vector<float>& openings() const { return openings_; }
    /// The casters that look() decoded.
    const ShadowMaps& casters() const { return maps_; }

 private:
    struct Work {
        Frame& frame;
        const Inputs& inputs;
        Lighting& target;
    };

    void add_bounce(uint32_t bounce, std::vector<Step<Work>>& steps);
    template <class Draw>
    Result<void> with_atlas(Lighting& target, uint32_t bounce, const Draw& draw);
    Result<StepResult> decode_or_skip(Work& work, bool known);
    Result<StepResult> draw_light_view(Work& work);
    Result<void> decode(Frame& frame);
    Result<void> place_importons(Frame& frame, const Inputs& inputs);
    Result<void> place_further_importons(Frame& frame, const Inputs& inputs);
    Result<void> seed(Work& work);
    Result<void> choose_seeds(Frame& frame, Seeds& target);
    Result<StepResult> draw_maps(Work& work, uint32_t bounce);
    Result<void> close_maps(Frame& frame, Seeds& seeds);
    Result<StepResult> race(Work& work, uint32_t bounce);
    Result<void> combine(Work& work, uint32_t bounce);
    uint32_t end_of_step(const Inputs& inputs, uint32_t maps) const;
    StepResult maps_result(uint32_t end, uint32_t maps);
    std::vector<LightView> light_views_of(const Frame& frame, const Inputs& inputs) const;

    StepRunner<Work> runner_;
    Basis basis_;
    uint32_t last_ = 1;       ///< the last bounce
    uint32_t maps_done_ = 0;  ///< in the present step
    uint32_t candidates_count_ = 0;
    size_t drawn_views_ = 0;

    Basis looked_;
    SkyDirections sky_;
    std::vector<float> openings_;
    LightSeeding light_seeding_;
    Seeds candidates_;
    ViewImportance view_importance_;
    ShadowMaps maps_;  ///< borrows the atlas of a bounce while it is drawn or read
    Redistribution redistribution_;
};

/// Returns the last bounce that these settings ask for; 0: none.
uint32_t last_bounce(const EngineSettings& settings);
/// Whether each bounce has an atlas of its own, so that its light can be used again: all of them together are
/// small enough.
bool keeps_bounces(const AtlasLayout& layout, uint32_t last);

}  // namespace lucarne::gi::vpl
