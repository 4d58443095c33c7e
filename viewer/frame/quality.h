#pragma once

#include <array>
#include <cstddef>

#include "io/core/options.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// Scales each side; the result is at least 16 pixels.
ImageSize scaled_size(ImageSize full, double scale);

/// Keeps pictures fast while the camera or a light moves. They never cost more than the preset `interactive`
/// asks for. First the picture gets smaller; if that is not enough, the cuts get as coarse as the cheapest
/// preset's. Light is not reduced, because engines make it over several frames (FrameRequest::light_budget).
/// At rest there is no reduction.
class MovingQuality {
 public:
    /// `longest`: the longest time for a picture, s. `scale`: that of the first pictures.
    explicit MovingQuality(double longest = 0.1, double scale = 1) : longest_(longest), scale_(scale) {}
    /// `frame_seconds`: duration of the last picture made during motion.
    void observe(double frame_seconds);
    double scale() const { return scale_; }  ///< scale of the picture's sides, 1/4 to 1
    bool reduced_settings() const { return reduced_; }

    ImageSize size(ImageSize full) const { return scaled_size(full, scale_); }
    /// Reduces settings and budgets for motion; they never cost more than at rest.
    void reduce(gi::EngineSettings& settings, CutBudgets& budgets) const;

 private:
    static constexpr size_t kObserved = 3;  ///< pictures, whose median counts: single ones may be disturbed
    double longest_, scale_;
    std::array<double, kObserved> last_{};
    size_t next_ = 0;  ///< pictures observed since the scale changed
    bool reduced_ = false;
};

}  // namespace lucarne::viewer
