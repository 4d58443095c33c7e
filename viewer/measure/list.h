#pragma once

#include <memory>
#include <vector>

#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// The measurements of a session. The last hundred changes can be undone.
class MeasureList {
 public:
    static constexpr size_t kMost = 10000, kMostUndone = 100;

    const std::vector<Measurement>& all() const { return *now_; }
    /// Adds a measurement. If it has no name, names it, for example "Distance 2". Returns false if the list
    /// is full.
    bool add(Measurement measurement);
    void remove(size_t index);
    void rename(size_t index, std::string name);
    void replace(std::vector<Measurement> all);
    void set_thickness(size_t index, double thickness);

    /// Multiplies all positions by `factor` to change the unit. This and all changes before it cannot be
    /// undone.
    void scale(double factor);

    /// Begins again with these, marked as saved: there is no change to undo.
    void restart(std::vector<Measurement> all);

    /// Marks the current measurements as saved, or as loaded from a file.
    void mark_saved() { saved_ = now_; }
    /// Whether the measurements differ from those marked as saved. False if all changes since then were
    /// undone.
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
