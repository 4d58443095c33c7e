#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

template <MeasureKind Kind>
void use(ViewModel& model) {
    if (model.measure.tool == Kind) return model.measure.stop();
    model.measure.start(Kind);
    model.side_bar().unfold(BarSection::measure);
}
template <MeasureKind Kind>
bool used(const ViewModel& model) {
    return model.measure.tool == Kind;
}
template <MeasureKind Kind>
constexpr Action tool(int key, const char* name) {
    return {{key, GLFW_MOD_CONTROL}, "Measure", name, use<Kind>, nullptr, used<Kind>};
}

bool measuring(const ViewModel& model) {
    return model.measure.tool.has_value();
}
bool has_pending(const ViewModel& model) {
    return !model.measure.pending.empty();
}
bool has_any(const ViewModel& model) {
    return !model.measure.list.all().empty();
}
bool has_selected(const ViewModel& model) {
    return model.measure.selected_one() != nullptr;
}
bool can_undo(const ViewModel& model) {
    return model.measure.list.can_undo();
}
bool can_redo(const ViewModel& model) {
    return model.measure.list.can_redo();
}
void finish(ViewModel& model) {
    if (!model.measure.finish()) model.measure.message = "more points are needed";
}
void copy(ViewModel& model) {
    model.measure.copy_selected();
}
void save_as(ViewModel& model, const char* extension) {
    model.measure.file = std::filesystem::path(model.measure.file).replace_extension(extension).string();
    model.measure.wish = MeasureModel::FileWish::save;
}

}  // namespace

std::span<const Action> measure_actions() {
    using Kind = MeasureKind;
    static constexpr std::array kActions = {
        tool<Kind::point>(GLFW_KEY_1, "Point"),
        tool<Kind::distance>(GLFW_KEY_2, "Distance"),
        tool<Kind::height>(GLFW_KEY_3, "Height"),
        tool<Kind::angle>(GLFW_KEY_4, "Angle"),
        tool<Kind::area>(GLFW_KEY_5, "Area"),
        tool<Kind::path>(GLFW_KEY_6, "Path"),
        tool<Kind::section>(GLFW_KEY_7, "Section"),
        Action{{GLFW_KEY_ENTER}, "Measure", "Finish the path or area", finish, measuring},
        Action{{GLFW_KEY_BACKSPACE},
               "Measure",
               "Take the last point back",
               [](ViewModel& m) { m.measure.drop_last(); },
               has_pending},
        Action{{GLFW_KEY_ESCAPE},
               "Measure",
               "Lay the tool away",
               [](ViewModel& m) { m.measure.stop(); },
               measuring},
        Action{{GLFW_KEY_DELETE},
               "Measure",
               "Delete the selected",
               [](ViewModel& m) { m.measure.remove_selected(); },
               has_selected},
        Action{{GLFW_KEY_Z, GLFW_MOD_CONTROL},
               "Measure",
               "Undo",
               [](ViewModel& m) { m.measure.undo(); },
               can_undo},
        Action{{GLFW_KEY_Y, GLFW_MOD_CONTROL},
               "Measure",
               "Redo",
               [](ViewModel& m) { m.measure.redo(); },
               can_redo},
        Action{{GLFW_KEY_C, GLFW_MOD_CONTROL}, "Measure", "Copy", copy, has_any},
        Action{{GLFW_KEY_U, GLFW_MOD_CONTROL},
               "Measure",
               "Metres",
               [](ViewModel& m) { m.measure.metres = !m.measure.metres; },
               nullptr,
               [](const ViewModel& m) { return m.measure.metres; }},
        Action{{GLFW_KEY_L, GLFW_MOD_CONTROL},
               "Measure",
               "Labels",
               [](ViewModel& m) { m.measure.labels = !m.measure.labels; },
               nullptr,
               [](const ViewModel& m) { return m.measure.labels; }},
        Action{{GLFW_KEY_E, GLFW_MOD_CONTROL},
               "Measure",
               "Save as CSV",
               [](ViewModel& m) { save_as(m, ".csv"); },
               has_any},
        Action{{GLFW_KEY_J, GLFW_MOD_CONTROL},
               "Measure",
               "Save as JSON",
               [](ViewModel& m) { save_as(m, ".json"); },
               has_any},
        Action{{GLFW_KEY_J, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT},
               "Measure",
               "Load",
               [](ViewModel& m) { m.measure.wish = MeasureModel::FileWish::load; }},
    };
    return kActions;
}

}  // namespace lucarne::viewer
