#include "viewer/window/controller_input.h"

#include <utility>

#include "viewer/camera/six_dof_drive.h"

namespace lucarne::viewer {

ControllerInput::ControllerInput(std::function<void()> wake)
    : controller_(io::Controller::start(std::move(wake))) {}

bool ControllerInput::take(ViewModel& model, double seconds) {
    ControllerModel& shown = model.controller;
    if (const auto status = controller_->status(); !(status == shown.status)) {
        shown.status = status;
        if (status.kind == io::ControllerStatus::Kind::connected)
            model.view.message = status.name + " connected";
        if (status.kind == io::ControllerStatus::Kind::refused)
            model.view.message = status.name + ": " + status.message;
    }
    const uint32_t pressed = controller_->take_pressed();
    if (pressed & 1) model.view.go_to(model.view.home);
    if (pressed & 2) shown.holds_object = !shown.holds_object;
    shown.cap = controller_->state();
    const io::SixDofState cap = model.settings.controller.apply(shown.cap);
    const bool moved = drive(cap, shown.holds_object ? SixDofHold::object : SixDofHold::camera,
                             model.view.navigation.speed(), seconds, model.view.rig);
    return moved || (pressed & 1);
}

}  // namespace lucarne::viewer
