#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// The measurements of a session.
class MeasureList {
 public:
    static constexpr size_t kMost = 10000;

    using State = std::shared_ptr<const std::vector<Measurement>>;

    const std::vector<Measurement>& all() const { return *now_; }
    /// The current measurements. become() restores them.
    const State& state() const { return now_; }
    void become(State state) { now_ = std::move(state); }
    /// Adds a measurement. If it has no name, names it, for example "Distance 2". Returns false if the list
    /// is full.
    bool add(Measurement measurement);
    void remove(size_t index);
    void rename(size_t index, std::string name);
    void replace(std::vector<Measurement> all);
    void set_thickness(size_t index, double thickness);

    /// Multiplies all positions by `factor` to change the unit.
    void scale(double factor);

    /// Replaces all measurements by these, marked as saved.
    void restart(std::vector<Measurement> all);

    /// Marks the current measurements as saved, or as loaded from a file.
    void mark_saved() { saved_ = now_; }
    /// Whether the measurements differ from those marked as saved. False if all changes since then were
    /// undone.
    bool unsaved() const { return now_ != saved_ && !(now_->empty() && saved_->empty()); }

 private:
    State now_ = std::make_shared<const std::vector<Measurement>>();
    State saved_ = now_;
};

}  // namespace lucarne::viewer
