#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "gi/scene/look.h"
#include "io/core/error.h"
#include "octree/tree/source.h"
#include "viewer/publish/single_order.h"

namespace lucarne::viewer {

/// Points to be written to a scan file: those that `look` shows.
struct ExportOrder {
    std::shared_ptr<const octree::NodeSource> source;
    gi::Look look;
    std::filesystem::path file;
    bool overwrite = false;
    double spacing = 0;  ///< metres between points; 0: all
    uint64_t every = 1;  ///< every so many-th of those that are left
};

struct ExportState {
    bool running = false;
    double share = 0;  ///< 0 to 1
    std::string file;
};

/// A thread that writes points like `lucarne export`, while the window stays usable. Call the members from
/// one thread; they never wait.
class ExportWorker {
 public:
    /// `changed` is called, by any thread, when state() or take_outcome() has something new.
    explicit ExportWorker(std::function<void()> changed) : work_(std::move(changed)) {}

    /// Starts an order. Returns false and does nothing while another order is running.
    bool start(ExportOrder order);
    /// Cancels; then there is no file, or the former one.
    void cancel() { work_.cancel(); }
    ExportState state() const { return work_.shown(); }
    /// Returns the last order's outcome once: what was written, or the error.
    std::optional<Result<std::string>> take_outcome() { return work_.take_outcome(); }

 private:
    Result<std::string> write(const ExportOrder& order);

    SingleOrder<ExportState> work_;
};

}  // namespace lucarne::viewer
