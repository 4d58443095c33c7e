#pragma once

#include <functional>
#include <span>
#include <vector>

#include "viewer/ui/key_chord.h"

namespace lucarne::viewer {

/// A command of the user: an item of a menu with a key. `Of` is what it acts on, for example
/// `const Measuring`. Each feature has an array of its actions.
template <class Of>
struct Action {
    KeyChord chord;
    const char* menu;  ///< its menu: "View", or "View/Projection" for a submenu
    const char* name;
    void (*run)(Of& of);
    bool (*enabled)(const Of& of) = nullptr;  ///< null: always enabled
    bool (*checked)(const Of& of) = nullptr;  ///< null: the action is not a switch
    KeyChord other{};                         ///< a second key, if any
};

/// An action together with what it acts on. Keys, menus and the help are all built from these, so that they
/// always agree. No function is empty.
struct BoundAction {
    KeyChord chord;
    const char* menu;
    const char* name;
    std::function<void()> run;
    std::function<bool()> enabled, checked;
    KeyChord other{};
};

/// Appends actions to `all`, bound to `of`: a copy of a feature's references, or a std::reference_wrapper.
template <class Of, class Bound>
void bind(std::span<const Action<Of>> actions, Bound of, std::vector<BoundAction>& all) {
    for (const Action<Of>& action : actions) {
        BoundAction& bound = all.emplace_back(action.chord, action.menu, action.name);
        bound.run = [run = action.run, of] { run(of); };
        bound.enabled = [enabled = action.enabled, of] { return !enabled || enabled(of); };
        bound.other = action.other;
        bound.checked = [checked = action.checked, of] { return checked && checked(of); };
    }
}

}  // namespace lucarne::viewer
