#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
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
#include "viewer/opening/moods.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

enum class ScanState {
    opening,     ///< being opened; nothing can be drawn yet
    sample,      ///< a sample is drawn; the conversion waits for its turn
    converting,  ///< finished parts are drawn, and the sample elsewhere
    elsewhere,   ///< a sample is drawn, and another program converts the scan
    stopped,     ///< the conversion was stopped or failed; go_on() continues it
    whole,       ///< a complete octree
    failed       ///< it could not be opened
};

/// What the window shows about an open scan, or about several that share one cache.
struct ScanRow {
    uint64_t id = 0;
    std::vector<std::string> paths;
    std::string folder;  ///< whose scans these are, if one folder was opened; empty otherwise
    ScanState state = ScanState::opening;
    bool visible = true;
    uint64_t points = 0;            ///< number of points in its files
    uint64_t memory = 0;            ///< bytes of its directory, without its points, which are streamed
    uint64_t file_bytes = 0;        ///< size of its files
    std::vector<uint64_t> of_path;  ///< points of each file if there are several
    std::string stage;              ///< stage of the current work, for example "normals"
    double share = 0;               ///< finished share of the stage, 0 to 1
    std::optional<Error> error;     ///< why it failed or was not finished
    std::optional<std::array<glm::dvec3, 2>> box;  ///< of what is known of it, world units

    std::string name() const;  ///< the folder or first file, and the number of files
    bool busy() const {
        return state == ScanState::opening || state == ScanState::sample || state == ScanState::converting ||
               state == ScanState::elsewhere;
    }
    /// Whether more of its points are to come.
    bool grows() const {
        return visible && (state == ScanState::sample || state == ScanState::converting ||
                           state == ScanState::elsewhere);
    }
};

/// Returns what the window's title says of these scans. Leaves out files that could not be opened.
std::string scans_title(const std::vector<ScanRow>& rows);

/// The starting camera and lights.
struct StartingView {
    gi::Scene scene;
    gi::SceneCamera camera;
    bool fits_window = false;             ///< the camera is the site's first view, to be fitted to the window
    std::optional<Mood> mood;             ///< the light is this mood's
    std::string engine;                   ///< what draws it at first
    std::filesystem::path prepared_file;  ///< holds what prepared_engine() computes in advance; empty: none
    std::filesystem::path prepared_place;  ///< where it would be kept; empty: nowhere
    Site site;
    std::array<glm::dvec3, 2> box{};  ///< the box to look at, world units
    double metres_per_unit = 1;
    double scene_size() const { return std::max(glm::distance(box[0], box[1]), 1e-6); }  ///< its diagonal
};

/// The scans that are open in the window. Scans are opened, converted, hidden and closed while the window
/// keeps drawing. Threads of this object do the work. Call the members from one thread; they never wait.
class ScanSet {
 public:
    /// Returns the starting view for all visible scans together. Called on another thread.
    using StartOf = std::function<Result<StartingView>(const octree::NodeSource&)>;

    /// `changed` is called, by any thread, when update() has something to apply.
    ScanSet(InputOptions how, StartOf start, std::function<void()> changed);
    ~ScanSet();
    ScanSet(const ScanSet&) = delete;
    ScanSet& operator=(const ScanSet&) = delete;

    /// Opens files, or the scans in folders. `together`: inputs that are not octrees yet become one cache.
    void open(std::vector<std::string> paths, bool together = false);
    void remove(uint64_t id);
    void set_visible(uint64_t id, bool visible);
    /// Stops a conversion; what is drawn of the scan stays. A scan that is still being opened is removed.
    void stop(uint64_t id);
    /// Continues a stopped conversion, from its last finished stage if its cache is kept.
    void go_on(uint64_t id);
    /// Starts the next conversion unless one is running.
    void convert_next();
    /// Says that a picture of source() has been made: conversions may wait for it.
    void seen();

    /// Applies finished background jobs; call once per frame. Opens a scan that is not converted again once
    /// another program has finished its cache, or has stopped converting it. Returns true if source() has
    /// changed.
    bool update();

    const std::vector<ScanRow>& rows() const { return rows_; }
    /// The visible scans as one source; null: there is nothing to draw.
    const std::shared_ptr<const octree::NodeSource>& source() const { return source_; }
    /// The starting view; nothing if finding it failed (see error()).
    const std::optional<StartingView>& start() const { return start_; }
    /// The ids of the scans that source() shows.
    const std::vector<uint64_t>& shown() const { return shown_; }
    bool converting() const;
    /// Whether source() lacks points that are to come: also while the scans are whole already, and the source
    /// that has all of them is still being made.
    bool grows() const;
    /// Whether no work is pending, so that rows and source() are final.
    bool settled() const;
    /// The error of the first failed scan, or of joining the visible scans.
    Result<void> error() const;

 private:
    struct Item;
    struct Shared;
    struct Joined;
    void open_one(std::vector<std::string> paths, bool together, uint64_t instead_of = 0,
                  std::string folder = {});
    void push_opening(uint64_t id, InputOptions how, bool together, uint64_t sample_points);
    void take_opened();
    void take_builds();
    void take_caches_of_others();
    void open_again(ScanRow& row, Item& item);
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
    std::vector<uint64_t> shown_;
    std::optional<StartingView> start_;
    std::optional<Error> problem_;  ///< error of joining the visible scans
    bool stale_ = false, joining_ = false;
    bool source_grows_ = false;                     ///< a scan in it was growing when it was made
    std::chrono::steady_clock::time_point looked_;  ///< for caches of others
    // The last members: they end before the members that their jobs use.
    JobQueue joiner_, opener_;
};

}  // namespace lucarne::viewer
