#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>

#include "viewer/ui/key_chord.h"
#include "viewer/window/view_model.h"
#include "viewer/window/window.h"

namespace lucarne::viewer {

/// Decides when the window closes: asks the user first if work is unsaved or still running.
class Closing {
 public:
    /// `keep` saves what is kept by itself, and returns whether nothing else would be lost.
    Closing(Window& window, ViewModel& model, std::function<bool()> keep)
        : window_(window), model_(model), keep_(std::move(keep)) {}

    void request() { requested_ = true; }
    /// Returns whether the window may close. Unless `at_once`, asks if something would be lost.
    bool agreed(bool at_once);
    /// Handles keys pressed while the question is shown.
    void answer(std::span<const KeyChord> keys);

 private:
    std::string reason_to_ask();

    Window& window_;
    ViewModel& model_;
    std::function<bool()> keep_;
    bool requested_ = false;
};

}  // namespace lucarne::viewer
