#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/measure/measuring.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Measuring>;

template <MeasureKind Kind>
void use(const Measuring& model) {
    if (model.measure.tool == Kind) return model.measure.stop();
    model.measure.start(Kind);
    model.view.side_bar.unfold(BarSection::measure);
}
template <MeasureKind Kind>
bool used(const Measuring& model) {
    return model.measure.tool == Kind;
}
template <MeasureKind Kind>
constexpr Entry tool(int key, const char* name) {
    return {{key, GLFW_MOD_CONTROL}, "Measure", name, use<Kind>, nullptr, used<Kind>};
}

bool measuring(const Measuring& model) {
    return model.measure.tool.has_value();
}
bool has_pending(const Measuring& model) {
    return !model.measure.pending.empty();
}
bool has_any(const Measuring& model) {
    return !model.measure.list.all().empty();
}
bool has_selected(const Measuring& model) {
    return model.measure.selected_one() != nullptr;
}
void finish(const Measuring& model) {
    if (!model.measure.finish()) model.measure.message = "click one more point";
}
void copy(const Measuring& model) {
    model.measure.copy_selected();
}
void save_as(const Measuring& model, const char* extension) {
    model.measure.file = std::filesystem::path(model.measure.file).replace_extension(extension).string();
    model.measure.commands.push(SaveMeasurements{});
}

}  // namespace

std::span<const Action<const Measuring>> measure_actions() {
    using Kind = MeasureKind;
    static constexpr std::array kActions = {
        tool<Kind::point>(GLFW_KEY_1, "Point"),
        tool<Kind::distance>(GLFW_KEY_2, "Distance"),
        tool<Kind::height>(GLFW_KEY_3, "Height"),
        tool<Kind::angle>(GLFW_KEY_4, "Angle"),
        tool<Kind::area>(GLFW_KEY_5, "Area"),
        tool<Kind::path>(GLFW_KEY_6, "Path"),
        tool<Kind::section>(GLFW_KEY_7, "Section"),
        Entry{{GLFW_KEY_ENTER}, "Measure", "Finish the path or area", finish, measuring},
        Entry{{GLFW_KEY_BACKSPACE},
              "Measure",
              "Remove last point",
              [](const Measuring& m) { m.measure.drop_last(); },
              has_pending},
        Entry{{GLFW_KEY_ESCAPE},
              "Measure",
              "Put tool away",
              [](const Measuring& m) { m.measure.stop(); },
              measuring},
        Entry{{GLFW_KEY_DELETE},
              "Measure",
              "Delete the selected",
              [](const Measuring& m) { m.measure.remove_selected(); },
              has_selected},
        Entry{{GLFW_KEY_C, GLFW_MOD_CONTROL}, "Measure", "Copy", copy, has_any},
        Entry{{GLFW_KEY_U, GLFW_MOD_CONTROL},
              "Measure",
              "Metres",
              [](const Measuring& m) { m.measure.metres = !m.measure.metres; },
              nullptr,
              [](const Measuring& m) { return m.measure.metres; }},
        Entry{{GLFW_KEY_L, GLFW_MOD_CONTROL},
              "Measure",
              "Labels",
              [](const Measuring& m) { m.measure.labels = !m.measure.labels; },
              nullptr,
              [](const Measuring& m) { return m.measure.labels; }},
        Entry{{GLFW_KEY_E, GLFW_MOD_CONTROL},
              "Measure",
              "Save as CSV",
              [](const Measuring& m) { save_as(m, ".csv"); },
              has_any},
        Entry{{GLFW_KEY_J, GLFW_MOD_CONTROL},
              "Measure",
              "Save as JSON",
              [](const Measuring& m) { save_as(m, ".json"); },
              has_any},
        Entry{{GLFW_KEY_J, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT},
              "Measure",
              "Load",
              [](const Measuring& m) { m.measure.commands.push(LoadMeasurements{}); }},
    };
    return kActions;
}

}  // namespace lucarne::viewer
