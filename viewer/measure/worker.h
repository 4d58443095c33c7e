#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "io/core/job_queue.h"
#include "viewer/measure/section/section.h"
#include "viewer/picking/pick.h"

namespace lucarne::viewer {

/// Reads points of a cloud for measuring, off the window's thread: picked points in the order of the clicks,
/// and one section at a time.
class MeasureWorker {
 public:
    /// `published` is called on a thread of this object when there is a new result.
    explicit MeasureWorker(std::function<void()> published) : published_(std::move(published)) {}

    ~MeasureWorker() { *stop_ = true; }
    MeasureWorker(const MeasureWorker&) = delete;
    MeasureWorker& operator=(const MeasureWorker&) = delete;

    /// Picks the point at a place of the picture. Drops the click if kMostWaiting clicks are waiting.
    void pick(std::shared_ptr<const Picture> picture, const glm::dvec2& place);
    static constexpr int kMostWaiting = 32;
    using Pick = Result<std::optional<PickedPoint>>;
    std::vector<Pick> take_picks();

    /// Starts reading a section and stops reading the previous one. Does nothing if it is the same section.
    void read(std::shared_ptr<const octree::NodeSource> source, const Slice& slice);
    /// Returns the section as far as it has been read; null before its first level.
    std::shared_ptr<const Section> section() const;
    /// Writes `base`.csv and .svg once the section has been read. Overwrites no files.
    void save_section(const std::filesystem::path& base, const std::string& title, const UnitChoice& units);
    /// Returns the newest message about errors or saved files, once.
    std::optional<std::string> take_message();

 private:
    NodeCache& cache_of(const std::shared_ptr<const octree::NodeSource>& source);
    void say(std::string message);
    Result<void> write_section(const std::filesystem::path& base, const std::string& title,
                               const UnitChoice& units);

    std::function<void()> published_;
    mutable std::mutex mutex_;
    std::vector<Pick> picks_;
    std::shared_ptr<const octree::NodeSource> section_source_;
    std::optional<Slice> slice_;
    std::shared_ptr<const Section> section_;
    std::optional<std::string> message_;
    std::atomic<int> waiting_{0};  ///< waiting picks
    /// Set to stop reading the section.
    std::shared_ptr<std::atomic<bool>> stop_ = std::make_shared<std::atomic<bool>>(false);
    std::unique_ptr<NodeCache> cache_;  ///< used by the picking thread
    JobQueue picking_, sections_;       ///< last members: they end before the members that they use
};

}  // namespace lucarne::viewer
