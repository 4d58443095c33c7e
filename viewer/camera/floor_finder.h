#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include <glm/vec3.hpp>

#include "io/core/job_queue.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Returns the floor under an eye, world z: the highest level on which several points agree, in a column as
/// wide as a foot and no higher than one step above the feet. `eye_height` is in world units. Reads nodes, so
/// it may block. Returns nothing where there are no points below.
std::optional<double> floor_below(const octree::NodeSource& source, const glm::dvec3& eye, double eye_height);

/// Runs floor_below() on a thread for the window. found() returns the newest answer at once.
class FloorFinder {
 public:
    /// Starts a new search when the eye has moved far enough. Never waits.
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
