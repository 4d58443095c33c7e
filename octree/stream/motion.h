#pragma once

#include <optional>

#include "octree/stream/cut.h"

namespace lucarne::octree {

/// Where a camera will be, from where it was: it goes on by the step of the last frames, in place and in
/// direction. The mean of two steps, so that a hand's tremble does not swing what is loaded ahead.
class Motion {
 public:
    /// The view of the next frame.
    void observe(const View& view);
    void forget();  ///< the camera has jumped
    /// The view `frames` frames on; empty while it stands or when too little is known.
    std::optional<View> ahead(double frames) const;

 private:
    std::optional<View> last_, before_, first_;
};

}  // namespace lucarne::octree
