#pragma once

#include <cstdint>
#include <vector>

#include "gi/engines/vpl/lighting.h"
#include "gi/engines/vpl/redistribution/redistribution.h"
#include "gi/engines/vpl/seeding/light_seeding.h"
#include "gi/engines/vpl/view_importance/view_importance.h"
#include "gi/frame.h"
#include "gi/lighting/sky_directions.h"

namespace lucarne::gi::vpl {

/// Makes a Lighting, step by step: it places VPLs on the surfaces that the lights see, draws their shadow
/// maps, redistributes the VPLs for the next bounce, and so on. A picture that must not wait for all of it
/// takes some steps in each frame, and shows earlier light meanwhile. From the first step to the last the
/// light cut must stay the same, and all of the basis but lights, environment and camera.
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
    };

    /// Starts anew.
    void begin(Basis basis);
    void stop() { next_ = Step::none; }
    bool running() const { return next_ != Step::none; }
    /// Whether what is being made may go on in a frame of another basis.
    bool goes_on(const Basis& now) const;

    /// Does the next step. `target` keeps what earlier steps made; it is whole when this is not running() any
    /// more. Errors: no device memory, a shader that fails.
    Result<void> step(Frame& frame, const Inputs& inputs, Lighting& target);

    /// Which bounce has its VPLs and maps since the last step; 0: none. Its atlas is overwritten by the next
    /// step if all bounces share one (keeps_bounces()).
    uint32_t made() const { return made_; }

    /// Decodes the casters and measures what matters to the camera, unless that was done for the same basis.
    Result<void> look(Frame& frame, const Inputs& inputs, const Basis& basis);
    /// The camera for which look() last measured importance.
    const CameraView& looked_from() const { return looked_.camera; }
    /// Whether a camera still sees about what it saw then.
    bool serves(const CameraView& camera) const { return view_importance_.serves(camera); }
    /// The directions of the sky, those favoured that reach what the camera saw then.
    const SkyDirections& sky() const { return sky_; }

 private:
    enum class Step : uint8_t {
        none,
        casters,
        importons,
        further_importons,
        light_views,
        seeds,
        importance,
        maps,
        closing,
        races,
        combination
    };

    Result<void> step_of_bounce(Frame& frame, const Inputs& inputs, Lighting& target);
    Result<void> decode(Frame& frame);
    Result<void> place_importons(Frame& frame, const Inputs& inputs);
    Result<void> place_further_importons(Frame& frame, const Inputs& inputs);
    Result<void> seed(Frame& frame, const Inputs& inputs, Seeds& target);
    Result<void> choose_seeds(Frame& frame, Seeds& target);
    Result<void> draw_maps(Frame& frame, const Inputs& inputs, Lighting& target);
    Result<void> close_maps(Frame& frame, Lighting& target);
    Result<void> race(Frame& frame, const Inputs& inputs, Lighting& target);
    Result<void> combine(Frame& frame, const Inputs& inputs, Lighting& target);
    uint32_t end_of_step(const Inputs& inputs, uint32_t maps) const;
    std::vector<LightView> light_views_of(const Frame& frame, const Inputs& inputs) const;
    bool needs_sources() const { return bounce_ < last_; }

    Step next_ = Step::none;
    Basis basis_;
    uint32_t bounce_ = 1, last_ = 1;  ///< the bounce that is being made, and the last one
    uint32_t made_ = 0;
    uint32_t maps_done_ = 0;  ///< of bounce_, in this kind of step
    uint32_t candidates_count_ = 0;
    size_t drawn_views_ = 0;

    Basis looked_;
    SkyDirections sky_;
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
