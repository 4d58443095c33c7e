#pragma once

#include <memory>

#include "io/input/controller.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// A 6-DoF controller beside mouse and keys: moves the model's camera by the user's mapping. Its first button
/// fits the view, its second changes what the cap is in the hand.
class ControllerInput {
 public:
    /// `wake`: there is something to take(); any thread.
    explicit ControllerInput(std::function<void()> wake);

    /// What was done since the last frame, `seconds` ago. True where the camera moved.
    bool take(ViewModel& model, double seconds);

 private:
    std::unique_ptr<io::Controller> controller_;
};

}  // namespace lucarne::viewer
