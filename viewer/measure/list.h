#pragma once

#include <memory>
#include <vector>

#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// The measurements of a session. Every change can be undone, the last hundred of them.
class MeasureList {
 public:
    static constexpr size_t kMost = 10000, kMostUndone = 100;

    const std::vector<Measurement>& all() const { return *now_; }
    /// Gives a name ("Distance 2") to one that has none. False when the list is full.
    bool add(Measurement measurement);
    void remove(size_t index);
    void rename(size_t index, std::string name);
    void replace(std::vector<Measurement> all);
    void set_thickness(size_t index, double thickness);

    /// All positions, to another unit. This cannot be undone, nor what was before.
    void scale(double factor);

    /// They are in a file now, or come from one.
    void mark_saved() { saved_ = now_; }
    /// Whether they are other than those marked last. Undoing all changes since makes them the same again.
    bool unsaved() const { return now_ != saved_ && !(now_->empty() && saved_->empty()); }

    bool can_undo() const { return !before_.empty(); }
    bool can_redo() const { return !after_.empty(); }
    void undo();
    void redo();

 private:
    using State = std::shared_ptr<const std::vector<Measurement>>;
    void become(std::vector<Measurement> next);

    State now_ = std::make_shared<const std::vector<Measurement>>();
    State saved_ = now_;
    std::vector<State> before_, after_;
};

}  // namespace lucarne::viewer
