#pragma once

#include <optional>

#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// Returns the camera after it has gone toward a point at its own height, up to `distance` from it, or half
/// way if it is nearer. It looks in the same direction as before.
gi::SceneCamera gone_toward(const gi::SceneCamera& camera, const glm::dvec3& point, double distance);

/// Moves a camera smoothly to another place, so that the eye can follow.
class CameraGlide {
 public:
    static constexpr double kSeconds = 0.7;

    /// Begins a glide. Parallel cameras jump.
    void start(const gi::SceneCamera& from, const gi::SceneCamera& to);
    void stop() { under_way_ = false; }
    bool under_way() const { return under_way_; }
    /// Returns the camera `seconds` later, or nothing if no glide is under way. The last camera is exactly
    /// the one that was asked for.
    std::optional<gi::SceneCamera> advance(double seconds);

 private:
    gi::SceneCamera from_, to_;
    double time_ = 0;
    bool under_way_ = false;
};

}  // namespace lucarne::viewer
