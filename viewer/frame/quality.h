#pragma once

#include "io/core/options.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// Scales each side; the result is at least 16 pixels.
ImageSize scaled_size(ImageSize full, double scale);

/// Keeps pictures fast while the camera or a light moves. First the picture gets smaller; if that is not
/// enough, the settings fall back to the cheapest preset's. At rest there is no reduction.
class MovingQuality {
 public:
    /// `wanted`: target seconds for a picture; 1.5 times as long is too slow.
    explicit MovingQuality(double wanted = 0.1) : wanted_(wanted) {}
    /// `frame_seconds`: duration of the last picture made during motion.
    void observe(double frame_seconds);
    double scale() const { return scale_; }  ///< scale of the picture's sides, 1/4 to 1
    bool reduced_settings() const { return reduced_; }

    ImageSize size(ImageSize full) const { return scaled_size(full, scale_); }
    /// Reduces settings and budgets for motion; they never cost more than at rest.
    void reduce(gi::EngineSettings& settings, CutBudgets& budgets) const;

 private:
    double wanted_, scale_ = 1;
    bool reduced_ = false;
};

}  // namespace lucarne::viewer
