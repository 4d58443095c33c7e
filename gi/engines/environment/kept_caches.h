#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gi/engines/environment/caches.h"
#include "gi/options.h"

namespace lucarne::gi::environment {

/// The caches of finished frames, for frames of a motion: while only the camera moves, their light is still
/// right, and most of what the next frames show lies among them. Holds at most kMostKept; the last
/// kMostGlossyCaches of them keep light by direction.
class KeptCaches {
 public:
    static constexpr size_t kMostKept = 131072;  ///< 18 MB

    /// Whether there are caches of this content (Frame::content), for as many bounces as `settings` ask for.
    bool hold(const EngineSettings& settings, uint64_t content) const;
    /// Takes the caches of a finished frame. Of earlier ones of the same content stay those that lie outside
    /// its picture: they are right when the camera turns back.
    void take(const CameraView& camera, const EngineSettings& settings, uint64_t content,
              std::span<const Cache> caches);
    /// Adds caches of a frame of the motion, if there is room.
    void add(std::span<const Cache> caches);
    std::span<const Cache> all() const { return caches_; }

 private:
    void drop_oldest_directions();

    bool any_ = false;
    uint64_t content_ = 0;
    uint32_t bounces_ = 0;
    int32_t only_bounce_ = -1;
    std::vector<Cache> caches_;
};

}  // namespace lucarne::gi::environment
