// Where a user's mouse finds things in the window.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "tests/viewer/window/imgui_context.h"
#include "viewer/opening/moods.h"
#include "viewer/ui/popups.h"
#include "viewer/window/actions/actions.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::test {

/// Finds menus and buttons by clicking the window's own panels in a context of the window's size, so that no
/// test knows their pixels.
class Places {
 public:
    explicit Places(const ImVec2& window) : size_(window), context_(window) {
        model_.view.site.outline = {glm::dvec3(0)};
        for (viewer::BoundAction action : viewer::bound_actions(model_)) {
            action.run = [this, name = action.name] { ran_ = name; };
            action.enabled = [this, name = action.name] {
                if (name == sought_) seen_ = true;
                return true;
            };
            actions_.push_back(std::move(action));
        }
    }

    /// Returns the places of the menu's title and of the action in the open menu, pixels. Nothing if there is
    /// no such action in a menu of the bar.
    std::optional<std::array<ImVec2, 2>> action(std::string_view name) {
        sought_ = name;
        ran_ = {};
        const auto draw = [&] { viewer::draw_menu_bar(model_, actions_); };
        for (ImVec2 title{4, kStep}; title.x < size_.x; title.x += kStep) {
            seen_ = false;
            context_.click(title, draw);
            for (ImVec2 item{title.x + kStep, 3 * kStep}; seen_ && item.y < size_.y; item.y += kStep) {
                viewer::close_popups();
                context_.click(title, draw);
                context_.click(item, draw);
                if (ran_ == name) return std::array{title, ImVec2(item.x, item.y + kStep / 4)};
            }
            viewer::close_popups();
        }
        return std::nullopt;
    }
    /// Returns the place of the mood's button.
    std::optional<ImVec2> mood(viewer::Mood mood) {
        const auto draw = [&] { viewer::draw_mood_bar(model_.lighting()); };
        for (ImVec2 place{0, 0}; place.y < size_.y / 4; place.y += kStep)
            for (place.x = 0; place.x < size_.x; place.x += kStep) {
                context_.click(place, draw);
                if (model_.lights.mood == mood) return ImVec2(place.x + kStep / 2, place.y + kStep / 4);
            }
        return std::nullopt;
    }

 private:
    static constexpr float kStep = 8;  ///< pixels, less than the half of a line of text with its frame

    ImVec2 size_;
    ImguiContext context_;
    viewer::ViewModel model_{1.0};
    std::vector<viewer::BoundAction> actions_;
    std::string_view sought_, ran_;
    bool seen_ = false;
};

}  // namespace lucarne::test
