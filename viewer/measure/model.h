#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "viewer/measure/list.h"
#include "viewer/measure/section.h"

namespace lucarne::viewer {

/// What the user measures with, and what was measured: the tools' part of the ViewModel.
struct MeasureModel {
    std::optional<MeasureKind> tool;  ///< takes the next clicks
    std::vector<ExactPoint> pending;  ///< those it has taken
    MeasureList list;
    std::optional<size_t> selected;  ///< in the list
    bool metres = true, labels = true;
    double thickness = 0;        ///< of the next section, world units; 0: none was chosen yet
    double metres_per_unit = 1;  ///< of the world, in which all positions are
    /// To save to and load from: .csv or .json.
    std::string file = "measurements.json";
    std::filesystem::path own_file;  ///< saved or loaded before

    // Wishes of actions and panels, which the session fulfils.
    enum class FileWish { none, save, load };
    FileWish wish = FileWish::none;
    bool save_section = false;
    std::optional<std::string> clipboard;
    // What it has.
    std::shared_ptr<const Section> section;  ///< of the selected one, as far as it was read
    std::string message;                     ///< to be shown once

    void start(MeasureKind kind);
    /// A point was picked: the tool has what it needs, or waits for more.
    void take(ExactPoint point);
    /// Ends a path or an area; false where it has too few points.
    bool finish();
    void drop_last();  ///< of the pending points
    void stop();       ///< lays the tool away
    void remove_selected();
    void undo();
    void redo();
    void copy_selected();  ///< all, where none is selected

    /// Whether measurements are in no file, or the tool's points are enough for one.
    bool unsaved() const { return list.unsaved() || can_finish(); }
    /// Writes over its own file alone. Errors: save_measurements().
    Result<void> save(const std::filesystem::path& path);
    /// Takes the place of all there is, which can be undone. Errors: load_measurements(); then nothing
    /// changes.
    Result<void> load(const std::filesystem::path& path);

    /// Another scan was opened or closed, and with it the unit of all together has changed.
    void set_unit(double its_metres_per_unit);

    bool can_finish() const { return tool && pending.size() >= info_of(*tool).least; }
    const Measurement* selected_one() const;
    UnitChoice units() const { return {metres, metres_per_unit}; }
};

}  // namespace lucarne::viewer
