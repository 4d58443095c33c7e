#pragma once

#include <memory>

#include "io/input/controller.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Input of a 6-DoF controller: moves the model's camera by the user's mapping. The first button returns to
/// the starting view. The second button switches the cap between moving the camera and moving the object.
class ControllerInput {
 public:
    /// `wake` is called, by any thread, when take() has new input.
    explicit ControllerInput(std::function<void()> wake);

    /// Applies input since the last frame, `seconds` ago. Returns true if the camera moved.
    bool take(ViewModel& model, double seconds);

 private:
    std::unique_ptr<io::Controller> controller_;
};

}  // namespace lucarne::viewer
