#pragma once

#include "io/core/options.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// A share of each side; 16 pixels at least.
ImageSize scaled_size(ImageSize full, double scale);

/// Keeps pictures coming while the camera or a light moves: first the picture gets smaller, then, where that
/// is not enough, the settings fall back to the cheapest preset's. At rest nothing is given up.
class MovingQuality {
 public:
    /// `wanted`: seconds a picture; half as much again is too slow.
    explicit MovingQuality(double wanted = 0.1) : wanted_(wanted) {}
    /// `frame_seconds`: how long the last picture took that was made while moving.
    void observe(double frame_seconds);
    double scale() const { return scale_; }  ///< of the picture's sides, 1/4 to 1
    bool reduced_settings() const { return reduced_; }

    ImageSize size(ImageSize full) const { return scaled_size(full, scale_); }
    /// The settings and budgets to move with, never dearer than those at rest.
    void reduce(gi::EngineSettings& settings, CutBudgets& budgets) const;

 private:
    double wanted_, scale_ = 1;
    bool reduced_ = false;
};

}  // namespace lucarne::viewer
