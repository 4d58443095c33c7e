#pragma once

#include <functional>

#include "viewer/light/lighting.h"
#include "viewer/light/sky_loader.h"

namespace lucarne::viewer {

/// Lights in the window: reads sky pictures, and lets the mouse move a light.
class LightSession {
 public:
    /// `wake` is called, by any thread, when a sky has been read.
    explicit LightSession(std::function<void()> wake) : skies_(std::move(wake)) {}

    /// Starts and finishes loading of sky pictures that the panel requests.
    void follow_sky(const Lighting& model);
    /// Shows the next picture of a day that is played, `seconds` after the last. Returns whether one is.
    bool follow_day(const Lighting& model, double seconds);
    /// Lets the mouse move the light while Shift is held.
    void take_gesture(const Lighting& model);

 private:
    SkyLoader skies_;
};

}  // namespace lucarne::viewer
