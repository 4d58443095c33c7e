#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "gi/scene/environment.h"
#include "io/core/job_queue.h"

namespace lucarne::viewer {

/// Reads sky pictures on a thread of its own, so that the window stays responsive. The newest request wins:
/// earlier requests are not started, or their pictures are dropped. So at most one picture is being read and
/// one waits.
class SkyLoader {
 public:
    using Sky = Result<std::shared_ptr<const gi::Environment>>;

    /// `done` is called on the loading thread once take() has a result.
    explicit SkyLoader(std::function<void()> done) : done_(std::move(done)) {}

    void load(std::string path);
    /// Returns the path being read, or an empty text.
    std::string reading() const;
    /// Returns the picture of the newest request, once. Returns nothing while it is being read.
    std::optional<Sky> take();

 private:
    struct Shared {
        std::mutex mutex;
        std::string wanted;    ///< path of the newest request; empty: it was taken
        uint64_t request = 0;  ///< number of the newest request
        std::optional<Sky> sky;
    };

    std::function<void()> done_;
    std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
    JobQueue jobs_;
};

}  // namespace lucarne::viewer
