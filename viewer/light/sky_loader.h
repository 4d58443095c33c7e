#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "gi/scene/environment.h"
#include "io/core/job_queue.h"

namespace lucarne::viewer {

/// Reads sky pictures on a thread of its own, so that the window answers meanwhile. The newest wish wins:
/// what was asked for before it is not begun, or its picture is dropped; so one is read and one waits at
/// most.
class SkyLoader {
 public:
    using Sky = Result<std::shared_ptr<const gi::Environment>>;

    /// `done` is called on the thread once there is something to take.
    explicit SkyLoader(std::function<void()> done) : done_(std::move(done)) {}

    void load(std::string path);
    /// What is being read; empty: nothing.
    std::string reading() const;
    /// The newest wish's picture, once; none while it is read.
    std::optional<Sky> take();

 private:
    struct Shared {
        std::mutex mutex;
        std::string wanted;  ///< the newest wish; empty: it was taken
        uint64_t wish = 0;   ///< its number
        std::optional<Sky> sky;
    };

    std::function<void()> done_;
    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
    JobQueue jobs_;
};

}  // namespace lucarne::viewer
