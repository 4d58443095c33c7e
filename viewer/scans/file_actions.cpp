#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/scans/scan_set.h"
#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

void open_file(ViewModel& model) {
    model.shell.want_file = true;
}
void close_scans(ViewModel& model) {
    const std::vector<ScanRow> rows = model.shell.scans->rows();
    for (const ScanRow& row : rows) model.shell.scans->remove(row.id);
}
bool has_scans(const ViewModel& model) {
    return model.shell.scans && !model.shell.scans->rows().empty();
}
void cancel(ViewModel& model) {
    const std::vector<ScanRow> rows = model.shell.scans->rows();
    for (const ScanRow& row : rows)
        if (row.busy()) model.shell.scans->stop(row.id);
}
bool is_busy(const ViewModel& model) {
    return has_scans(model) && std::ranges::any_of(model.shell.scans->rows(), &ScanRow::busy);
}
void go_on(ViewModel& model) {
    for (const ScanRow& row : model.shell.scans->rows()) model.shell.scans->go_on(row.id);
}
bool is_stopped(const ViewModel& model) {
    return has_scans(model) && std::ranges::any_of(model.shell.scans->rows(), [](const ScanRow& row) {
               return row.state == ScanState::stopped;
           });
}
void save_scene(ViewModel& model) {
    model.light_tools.save_scene = true;
}
void save_picture(ViewModel& model) {
    model.save_picture = true;
}
bool has_picture(const ViewModel& model) {
    return model.picture != nullptr;
}
void close(ViewModel& model) {
    model.close = true;
}

}  // namespace

std::span<const Action> file_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_O, GLFW_MOD_CONTROL}, "File", "Open scans...", open_file},
        Action{{GLFW_KEY_W, GLFW_MOD_CONTROL}, "File", "Close all scans", close_scans, has_scans},
        Action{{GLFW_KEY_PERIOD, GLFW_MOD_CONTROL}, "File", "Cancel loads and conversions", cancel, is_busy},
        Action{{GLFW_KEY_COMMA, GLFW_MOD_CONTROL}, "File", "Go on with conversions", go_on, is_stopped},
        Action{{GLFW_KEY_S, GLFW_MOD_CONTROL}, "File", "Save scene", save_scene},
        Action{{GLFW_KEY_F12}, "File", "Save the picture as PNG", save_picture, has_picture},
        Action{{GLFW_KEY_Q, GLFW_MOD_CONTROL}, "File", "Quit", close},
    };
    return kActions;
}

}  // namespace lucarne::viewer
