#pragma once

#include <cstdint>
#include <vector>

#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi {

/// Draws the G-buffers of light views, which are also their shadow maps, and holds as many as possible.
/// They take at most a third of the device's memory (but six of them, a point light's, are always held).
class LightGBuffers {
 public:
    /// Sets which views will be looked at, again and again in this order, and how many G-buffers are worth
    /// holding: `wanted` of the size of the largest view. Frees others. Call once a frame.
    void begin(const Device& device, const std::vector<LightView>& views, size_t wanted);

    /// Returns the G-buffer of a view; draws it unless it is held. It is valid until the next call. Errors:
    /// no device memory, a shader that fails.
    Result<const GBuffer*> look(Device& device, const LightView& view);
    /// Likewise, but a G-buffer of the same view is good enough if it was drawn from another state of its
    /// cut.
    Result<const GBuffer*> look_at_any_state(Device& device, const LightView& view);
    /// Draws the first of these views that is not held in the present state of its cut. Returns false if all
    /// of them are. Errors as above.
    Result<bool> draw_missing(Device& device, const std::vector<LightView>& views);
    /// Draws as many of these as the frame's light_budget allows. Errors as above.
    Result<void> renew(Frame& frame, const std::vector<LightView>& views);

 private:
    /// A drawn light view, without the scratch buffers of rasterize().
    struct Held {
        CameraView view{};
        uint64_t cut = 0;
        uint64_t used = 0;    ///< number of the call of look() that used it last; 0: empty
        bool wanted = false;  ///< is one of the views of begin()
        GBuffer gbuffer;
    };
    std::vector<Held>::iterator place_for(const LightView& view);
    template <class Match>
    Result<const GBuffer*> find_or_draw(Device& device, const LightView& view, const Match& match);

    std::vector<Held> held_;
    size_t most_ = 1;
    uint64_t uses_ = 0;
    GBuffer scratch_;
};

}  // namespace lucarne::gi
