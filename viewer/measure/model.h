#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "viewer/measure/list.h"
#include "viewer/measure/section/section.h"
#include "viewer/ui/command_queue.h"

namespace lucarne::viewer {

// Commands of the actions and panels. The session carries them out once there is a picture, since the first
// scan determines the unit.
struct SaveMeasurements {};  ///< to MeasureModel::file
struct LoadMeasurements {};
struct SaveSection {};  ///< the selected one
struct CopyText {
    std::string text;
};

/// Measuring tools, options and measurements.
struct MeasureModel {
    std::optional<MeasureKind> tool;  ///< the active tool, which receives the next clicks
    std::vector<ExactPoint> pending;  ///< points that the tool has received
    MeasureList list;
    std::optional<size_t> selected;  ///< in the list
    bool metres = true, labels = true;
    double thickness = 0;        ///< of the next section, world units; 0: not chosen yet
    double metres_per_unit = 1;  ///< the world unit, in which all positions are given
    /// File to save to and load from: .csv or .json.
    std::string file = "measurements.json";
    std::filesystem::path own_file;  ///< the file that was saved or loaded last

    CommandQueue<SaveMeasurements, LoadMeasurements, SaveSection, CopyText> commands;
    // Results of the session.
    std::shared_ptr<const Section> section;  ///< the selected section, as far as it has been read
    std::string message;                     ///< message to be shown once
    std::string prompt;                      ///< what the tool has said last; it ends with the tool

    void start(MeasureKind kind);
    /// Passes a picked point to the tool, which completes the measurement or waits for more points.
    void take(ExactPoint point);
    /// Completes a path or an area. Returns false if it has too few points.
    bool finish();
    void drop_last();  ///< removes the last pending point
    void stop();       ///< deactivates the tool
    void remove_selected();
    void copy_selected();  ///< copies all if none is selected

    /// Whether there are unsaved measurements, or pending points that are enough for one.
    bool unsaved() const { return list.unsaved() || can_finish(); }
    /// Saves the measurements. Overwrites only `own_file`. Errors: those of save_measurements().
    Result<void> save(const std::filesystem::path& path);
    /// Replaces all measurements by those of a file. Errors: those of
    /// load_measurements(); on failure nothing changes.
    Result<void> load(const std::filesystem::path& path);

    /// Shows measurements that were kept: no change to save.
    void restore(std::vector<Measurement> kept, double its_metres_per_unit);

    /// Call when the unit of the whole source has changed because a scan was opened or closed.
    void set_unit(double its_metres_per_unit);

    bool can_finish() const { return tool && pending.size() >= info_of(*tool).least; }
    const Measurement* selected_one() const;
    UnitChoice units() const { return {metres, metres_per_unit}; }
};

}  // namespace lucarne::viewer
