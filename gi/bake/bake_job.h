#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "gi/bake/precomputation.h"
#include "gi/engine.h"
#include "io/core/progress.h"

namespace lucarne::gi {

/// What is computed in advance, for which input, and where it is kept.
struct BakeOrder {
    const EngineInfo* engine = nullptr;  ///< one that precomputes
    std::shared_ptr<const octree::NodeSource> source;
    std::shared_ptr<const SurfelPreparation> preparation;
    octree::Cut cut;
    BakeInput input;             ///< without the cut's surfels; cut.frame is set
    bool fill_holes = true;      ///< with the source's synthetic surfels
    Clip clip;                   ///< of what neither blocks nor reflects light
    std::filesystem::path file;  ///< empty: nothing is kept
    std::filesystem::path
        read_only;                  ///< another that is read if `file` holds nothing for this input; or empty
    uint64_t most_bytes = 1 << 30;  ///< of the file when unpacked
};

/// Computes a precomputation on a thread of its own: loads the cut, restores what was kept, takes the steps,
/// and keeps the result, also an unfinished one. Thread-safe.
class BakeJob {
 public:
    struct Status;
    /// `published` is called on the job's thread with status() when that has news: another bake, the end, and
    /// from time to time the finished share.
    explicit BakeJob(
        BakeOrder order, std::function<void(const Status&)> published = [](const Status&) {});
    /// Stops, and waits until what is done is kept.
    ~BakeJob();
    /// Asks it to stop after the present step.
    void stop() { stop_ = true; }
    BakeJob(const BakeJob&) = delete;
    BakeJob& operator=(const BakeJob&) = delete;

    struct Status {
        std::shared_ptr<const Bake> bake;  ///< what is usable so far, or null
        uint64_t version = 0;              ///< grows with each `bake`
        double share = 0;                  ///< the finished share, 0..1
        std::string step;                  ///< the name of the step that is being taken; empty at the end
        bool ended = false;                ///< finished or failed
        Result<void> error;                ///< why it failed
        Result<void> keeping;              ///< why the result could not be kept
        std::filesystem::path file;        ///< that holds the result; empty: none does
    };
    Status status() const;
    /// Waits until it has ended or `stop` is true (null: never). `progress` counts thousandths of the work.
    void wait(const std::atomic<bool>* stop = nullptr, Progress* progress = nullptr) const;

 private:
    Result<void> compute();
    Result<void> keep(const Precomputation& work, uint64_t key);
    std::unique_ptr<Precomputation> begin(uint64_t key);
    Result<std::unique_ptr<Precomputation>> restored(const std::filesystem::path& path, uint64_t key) const;
    void note(const Precomputation& work, std::string_view step);

    BakeOrder order_;
    std::function<void(const Status&)> published_;
    std::atomic<bool> stop_ = false;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    Status status_;
    std::chrono::steady_clock::time_point told_{};  ///< of the last call of `published_`
    std::thread thread_;
};

}  // namespace lucarne::gi
