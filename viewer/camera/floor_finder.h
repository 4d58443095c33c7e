#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include <glm/vec3.hpp>

#include "io/core/job_queue.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// The floor under an eye, world z: the highest place below that several points agree on, as wide as a foot
/// stands, no higher than a step above where the feet would be. `eye_height` in world units. Reads nodes, so
/// it may block. None: there is nothing below.
std::optional<double> floor_below(const octree::NodeSource& source, const glm::dvec3& eye, double eye_height);

/// The same by a thread, for a window: the newest answer is at hand at once.
class FloorFinder {
 public:
    /// Looks again where the eye has gone some way; never waits.
    void look(const std::shared_ptr<const octree::NodeSource>& source, const glm::dvec3& eye,
              double eye_height);
    std::optional<double> found() const;

 private:
    struct Shared {
        std::mutex mutex;
        std::optional<double> floor;
        bool looking = false;
    };
    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
    std::shared_ptr<const octree::NodeSource> source_;
    std::optional<glm::dvec3> asked_;
    JobQueue jobs_;
};

}  // namespace lucarne::viewer
