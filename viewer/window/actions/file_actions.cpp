#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/scans/scan_set.h"
#include "viewer/window/actions/actions.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<ViewModel>;

void open_file(ViewModel& model) {
    model.scan_commands.push(ChooseFiles{});
}
void close_scans(ViewModel& model) {
    const std::vector<ScanRow> rows = model.scans->rows();
    for (const ScanRow& row : rows) model.scans->remove(row.id);
}
bool has_scans(const ViewModel& model) {
    return model.scans && !model.scans->rows().empty();
}
void cancel(ViewModel& model) {
    const std::vector<ScanRow> rows = model.scans->rows();
    for (const ScanRow& row : rows)
        if (row.busy()) model.scans->stop(row.id);
}
bool is_busy(const ViewModel& model) {
    return has_scans(model) && std::ranges::any_of(model.scans->rows(), &ScanRow::busy);
}
void go_on(ViewModel& model) {
    for (const ScanRow& row : model.scans->rows()) model.scans->go_on(row.id);
}
bool is_stopped(const ViewModel& model) {
    return has_scans(model) && std::ranges::any_of(model.scans->rows(), [](const ScanRow& row) {
               return row.state == ScanState::stopped;
           });
}
/// Asks for a file. Proposes one beside the saved pictures, named after the first scan.
void ask(ViewModel& model, FileQuestion& question, const char* ending) {
    std::string& file = question.file;
    if (file.empty()) {
        const std::filesystem::path scan =
            has_scans(model) ? model.scans->rows().front().paths.front() : "lucarne";
        std::error_code unknown;
        file = std::filesystem::absolute(model.view.pictures / (scan.stem().string() + ending), unknown)
                   .lexically_normal()
                   .string();
    }
    question.ask();
}
void save_scene_as(ViewModel& model) {
    if (model.scene_name.file.empty() && !model.scene_file.path().empty())
        model.scene_name.file = absolute_path(model.scene_file.path().string());
    ask(model, model.scene_name, "-scene.json");
}
/// Asks for a name the first time.
void save_scene(ViewModel& model) {
    if (model.scene_file.path().empty()) return save_scene_as(model);
    model.commands.push(SaveScene{});
}
void save_project(ViewModel& model) {
    ask(model, model.project_name, "-project.json");
}
void export_points(ViewModel& model) {
    ask(model, model.exporting.name, "-part.laz");
}
void cancel_export(ViewModel& model) {
    model.exporting.cancel = true;
}
bool is_exporting(const ViewModel& model) {
    return model.exporting.running;
}
void save_picture(ViewModel& model) {
    model.commands.push(SavePicture{});
}
bool can_save_picture(const ViewModel& model) {
    return model.view.picture != nullptr;
}
void close(ViewModel& model) {
    model.commands.push(Close{});
}

}  // namespace

std::span<const Action<ViewModel>> file_actions() {
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_O, GLFW_MOD_CONTROL}, "File", "Open scans...", open_file},
        Entry{{GLFW_KEY_W, GLFW_MOD_CONTROL}, "File", "Close all scans", close_scans, has_scans},
        Entry{{GLFW_KEY_PERIOD, GLFW_MOD_CONTROL}, "File", "Cancel loads and conversions", cancel, is_busy},
        Entry{{GLFW_KEY_COMMA, GLFW_MOD_CONTROL}, "File", "Resume conversions", go_on, is_stopped},
        Entry{{GLFW_KEY_O, GLFW_MOD_CONTROL | GLFW_MOD_ALT}, "File", "Open scene...", open_file, has_scans},
        Entry{{GLFW_KEY_S, GLFW_MOD_CONTROL}, "File", "Save scene", save_scene},
        Entry{{GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_ALT}, "File", "Save scene as...", save_scene_as},
        Entry{{GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT},
              "File",
              "Save project as...",
              save_project,
              has_scans},
        Entry{{GLFW_KEY_E, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT},
              "File",
              "Export points...",
              export_points,
              has_scans},
        Entry{{GLFW_KEY_E, GLFW_MOD_CONTROL | GLFW_MOD_ALT},
              "File",
              "Cancel export",
              cancel_export,
              is_exporting},
        Entry{{GLFW_KEY_F12}, "File", "Save the picture as PNG", save_picture, can_save_picture},
        Entry{{GLFW_KEY_Q, GLFW_MOD_CONTROL}, "File", "Quit", close},
    };
    return kActions;
}

}  // namespace lucarne::viewer
