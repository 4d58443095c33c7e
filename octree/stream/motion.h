#pragma once

#include <optional>

#include "octree/stream/cut.h"

namespace lucarne::octree {

/// Predicts the views of a moving camera: it repeats the step of the last frames, in position and direction.
/// The step is the mean of two, so that a trembling hand does not change what is prefetched.
class Motion {
 public:
    /// Takes the view of the next frame.
    void observe(const View& view);
    void forget();  ///< call when the camera has jumped
    /// Returns the view `frames` frames ahead; empty while the camera stands still or too few frames are
    /// known.
    std::optional<View> ahead(double frames) const;

 private:
    std::optional<View> last_, before_, first_;
};

}  // namespace lucarne::octree
