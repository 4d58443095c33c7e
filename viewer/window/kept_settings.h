#pragma once

#include "io/core/job_queue.h"
#include "viewer/window/view_model.h"
#include "viewer/window/window.h"

namespace lucarne::viewer {

/// Saves the settings: at the end, and when save() is called.
class KeptSettings {
 public:
    KeptSettings(const Window& window, const ViewModel& model) : window_(window), model_(model) {}
    /// Reports failures on the terminal, because the window is gone.
    ~KeptSettings();
    KeptSettings(const KeptSettings&) = delete;
    KeptSettings& operator=(const KeptSettings&) = delete;

    /// Saves on a thread, since a disk may be slow.
    void save();

 private:
    Settings current() const;

    const Window& window_;
    const ViewModel& model_;
    JobQueue writer_;
};

}  // namespace lucarne::viewer
