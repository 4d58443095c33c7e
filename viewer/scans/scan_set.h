#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/scene/scene.h"
#include "io/core/job_queue.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {

enum class ScanState {
    opening,     ///< being looked at; nothing of it can be drawn yet
    sample,      ///< a sample of it is drawn, its conversion waits for its turn
    converting,  ///< what is finished of it is drawn, and the sample where nothing is
    stopped,     ///< as it was when its conversion was stopped or failed; go_on() takes it up again
    whole,       ///< an octree
    failed       ///< it could not be opened
};

/// What there is to say about an open scan, or several that share one cache.
struct ScanRow {
    uint64_t id = 0;
    std::vector<std::string> paths;
    ScanState state = ScanState::opening;
    bool visible = true;
    uint64_t points = 0;            ///< in its files
    uint64_t memory = 0;            ///< bytes of its directory; its points come and go
    uint64_t file_bytes = 0;        ///< of its files
    std::vector<uint64_t> of_path;  ///< points, where there are several files
    std::string stage;              ///< of what goes on: "normals"
    double share = 0;               ///< of the stage that is done, 0 to 1
    std::optional<Error> error;     ///< why it failed or was not finished

    std::string name() const;  ///< the first file's, and how many more
    bool busy() const {
        return state == ScanState::opening || state == ScanState::sample || state == ScanState::converting;
    }
};

/// Where the view begins, and in what light.
struct StartingView {
    gi::Scene scene;
    gi::SceneCamera camera;
    std::array<glm::dvec3, 2> box{};  ///< to look at, world units
    double metres_per_unit = 1;
    double scene_size() const { return std::max(glm::distance(box[0], box[1]), 1e-6); }  ///< its diagonal
};

/// The scans that are open in the window: they are opened, converted, hidden and closed while it goes on
/// drawing. All is done by threads of its own; members are called by one thread and never wait.
class ScanSet {
 public:
    /// For the visible scans together; called on a thread of its own.
    using StartOf = std::function<Result<StartingView>(const octree::NodeSource&)>;

    /// `changed`: something is to be seen by update(); any thread.
    ScanSet(InputOptions how, StartOf start, std::function<void()> changed);
    ~ScanSet();
    ScanSet(const ScanSet&) = delete;
    ScanSet& operator=(const ScanSet&) = delete;

    /// Opens files, or the scans in folders. `together`: what is no octree yet becomes one cache.
    void open(std::vector<std::string> paths, bool together = false);
    void remove(uint64_t id);
    void set_visible(uint64_t id, bool visible);
    /// Stops a conversion; what is drawn of it stays. What is still being opened is removed.
    void stop(uint64_t id);
    /// Takes a stopped conversion up again, from its last whole stage where its cache has a place.
    void go_on(uint64_t id);
    /// Begins the next conversion, unless one is at work.
    void convert_next();

    /// Takes in what the threads have done. True: source() is another than before.
    bool update();

    const std::vector<ScanRow>& rows() const { return rows_; }
    /// The visible scans as one; null: there is nothing to draw.
    const std::shared_ptr<const octree::NodeSource>& source() const { return source_; }
    /// How they are looked at first; none where that failed (see error()).
    const std::optional<StartingView>& start() const { return start_; }
    bool converting() const;
    /// Nothing is on its way: rows and source() are what they will be.
    bool settled() const;
    /// Of the first scan that failed, or of all together.
    Result<void> error() const;

 private:
    struct Item;
    struct Shared;
    struct Joined;
    void open_one(std::vector<std::string> paths, bool together, uint64_t instead_of = 0);
    void push_opening(uint64_t id, InputOptions how, bool together, uint64_t sample_points);
    void take_opened();
    void take_builds();
    void take_joined();
    void join_visible();
    void retire(Item& item);
    void describe(const Item& item, ScanRow& row) const;
    ScanRow* row_of(uint64_t id);

    InputOptions how_;
    StartOf start_of_;
    std::shared_ptr<Shared> shared_;
    std::vector<ScanRow> rows_;
    std::map<uint64_t, Item> items_;
    uint64_t next_id_ = 1;
    std::shared_ptr<const octree::NodeSource> source_;
    std::optional<StartingView> start_;
    std::optional<Error> problem_;  ///< of the visible scans together
    bool stale_ = false, joining_ = false;
    // The last members: they end before what their jobs use.
    JobQueue joiner_, opener_;
};

}  // namespace lucarne::viewer
