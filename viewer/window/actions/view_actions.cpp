#include <array>
#include <numbers>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "viewer/opening/first_view.h"
#include "viewer/ui/on_screen.h"
#include "viewer/window/actions/actions.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<ViewModel>;

constexpr double kRight = std::numbers::pi / 2;  ///< a right angle, radians

void go_home(ViewModel& model) {
    model.view.go_to(model.view.home);
}
void fit(ViewModel& model) {
    model.view.rig.fit(model.view.box, picture_shape(model.view.side_bar));
}
/// The lights follow the camera through the door.
void light_place(ViewModel& model) {
    if (model.view.site.kind == SiteKind::interior) return;
    model.history.without_step(model, [&] { light_for_place(model.lighting()); });
}
void go_inside(ViewModel& model) {
    if (!model.view.site.inside) {
        model.view.go_to(ground_view(model.view.site, picture_shape(model.view.side_bar)));
        return;
    }
    model.view.entered = true;
    model.view.go_to(inside_view(model.view.site, picture_shape(model.view.side_bar)));
    light_place(model);
}
bool has_inside(const ViewModel& model) {
    return model.view.site.inside || model.view.site.kind == SiteKind::terrain;
}
void go_outside(ViewModel& model) {
    model.view.entered = false;
    model.view.go_to(outside_view(model.view.site, picture_shape(model.view.side_bar)));
    light_place(model);
}
bool has_picture(const ViewModel& model) {
    return model.view.picture != nullptr;
}

/// Looks at all open scans from outside. Seen from above, north (y) is up.
template <int kYaw, int kPitch>
void look(ViewModel& model) {
    model.view.entered = false;
    model.view.rig.look_along(kYaw * kRight, kPitch * kRight);
    fit(model);
}

void toggle_projection(ViewModel& model) {
    model.view.rig.set_orthographic(!model.view.rig.orthographic());
}
bool orthographic(const ViewModel& model) {
    return model.view.rig.orthographic();
}

template <NavigationMode kMode>
void navigate(ViewModel& model) {
    model.view.navigation.set_mode(kMode);
    if (!model.view.navigation.turns_scene())
        model.view.rig.set_orthographic(false);  // flying and walking need perspective
    switch (kMode) {
        case NavigationMode::orbit:
            model.view.message = "Orbit: drag to rotate around the point under the cursor";
            break;
        case NavigationMode::turntable:
            model.view.message = "Turntable: drag to rotate around the pivot (double-click)";
            break;
        case NavigationMode::fly:
            model.view.message = "Fly: W A S D, E and Q for up and down";
            break;
        case NavigationMode::walk:
            model.view.message = "Walk: W A S D, at eye height above the floor";
            break;
    }
}
template <NavigationMode kMode>
bool navigates(const ViewModel& model) {
    return model.view.navigation.mode() == kMode;
}
void toggle_gravity(ViewModel& model) {
    model.view.navigation.set_gravity(!model.view.navigation.gravity());
}
bool gravity(const ViewModel& model) {
    return model.view.navigation.gravity();
}

}  // namespace

std::span<const Action<ViewModel>> view_actions() {
    using enum NavigationMode;
    static constexpr const char *kMenu = "View", *kSides = "View/Standard views", *kModes = "View/Navigation";
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_HOME}, kMenu, "Back to the first view", go_home, has_picture},
        Entry{{GLFW_KEY_0}, kMenu, "Fit all", fit, has_picture},
        Entry{{GLFW_KEY_END}, kMenu, "Go inside", go_inside, has_inside},
        Entry{{GLFW_KEY_END, GLFW_MOD_SHIFT}, kMenu, "Go outside", go_outside, has_picture},
        Entry{{GLFW_KEY_9}, kMenu, "Orthographic", toggle_projection, nullptr, orthographic},
        Entry{{GLFW_KEY_1}, kSides, "Front", look<1, 0>, has_picture},
        Entry{{GLFW_KEY_2}, kSides, "Back", look<-1, 0>, has_picture},
        Entry{{GLFW_KEY_3}, kSides, "Left", look<0, 0>, has_picture},
        Entry{{GLFW_KEY_4}, kSides, "Right", look<2, 0>, has_picture},
        Entry{{GLFW_KEY_5}, kSides, "Top", look<1, -1>, has_picture},
        Entry{{GLFW_KEY_6}, kSides, "Bottom", look<1, 1>, has_picture},
        Entry{{GLFW_KEY_O}, kModes, "Orbit", navigate<orbit>, nullptr, navigates<orbit>},
        Entry{{GLFW_KEY_T}, kModes, "Turntable", navigate<turntable>, nullptr, navigates<turntable>},
        Entry{{GLFW_KEY_F}, kModes, "Fly", navigate<fly>, nullptr, navigates<fly>},
        Entry{{GLFW_KEY_H}, kModes, "Walk", navigate<walk>, nullptr, navigates<walk>},
        Entry{{GLFW_KEY_J}, kModes, "Gravity while walking", toggle_gravity, nullptr, gravity},
    };
    return kActions;
}

}  // namespace lucarne::viewer
