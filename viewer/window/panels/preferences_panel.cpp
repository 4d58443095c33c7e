#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <imgui.h>

#include "io/core/options.h"
#include "viewer/ui/widgets.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

constexpr uint64_t kMiB = 1 << 20;

void text_size(Settings& settings) {
    static constexpr std::array kSizes = {0.75, 1.0, 1.25, 1.5, 2.0, 3.0};
    const auto name = [](double size) { return std::to_string(static_cast<int>(100 * size + 0.5)) + " %"; };
    if (!ImGui::BeginCombo(LeftLabel("Text size"), name(settings.text_size).c_str())) return;
    for (const double size : kSizes)
        if (ImGui::Selectable(name(size).c_str(), size == settings.text_size)) settings.text_size = size;
    ImGui::EndCombo();
}

void navigation(Navigation& navigation) {
    static constexpr std::array kModes = {
        std::pair{NavigationMode::orbit, "Orbit"}, std::pair{NavigationMode::turntable, "Turntable"},
        std::pair{NavigationMode::fly, "Fly"}, std::pair{NavigationMode::walk, "Walk"}};
    const auto now =
        std::ranges::find(kModes, navigation.mode(), [](const auto& mode) { return mode.first; });
    if (!ImGui::BeginCombo(LeftLabel("Navigation"), now == kModes.end() ? "" : now->second)) return;
    for (const auto& [mode, label] : kModes)
        if (ImGui::Selectable(label, mode == navigation.mode())) navigation.set_mode(mode);
    ImGui::EndCombo();
}

void device_memory(Settings& settings) {
    static constexpr std::array kCaps = {512.0, 1024.0, 2048.0, 4096.0, 8192.0, 16384.0};
    const auto name = [](double cap) {
        return cap > 0 ? bytes_text(static_cast<uint64_t>(cap) * kMiB) : std::string("Usual");
    };
    const bool open = ImGui::BeginCombo(LeftLabel("Device memory"), name(settings.device_memory).c_str());
    if (open) {
        if (ImGui::Selectable("Usual", settings.device_memory == 0)) settings.device_memory = 0;
        for (const double cap : kCaps)
            if (ImGui::Selectable(name(cap).c_str(), cap == settings.device_memory))
                settings.device_memory = cap;
        ImGui::EndCombo();
    }
    help_mark("largest memory for points, pictures and light, from the next start on");
}

void sensitivity(io::SixDofMapping& mapping) {
    auto value = static_cast<float>(mapping.sensitivity);
    if (ImGui::SliderFloat(LeftLabel("Controller"), &value, 0.05f, 10, "%.2f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        mapping.sensitivity = value;
    help_mark("sensitivity of a 6-DoF controller");
}

}  // namespace

void draw_preferences_panel(ViewModel& model) {
    text_size(model.settings);
    navigation(model.view.navigation);
    device_memory(model.settings);
    sensitivity(model.settings.controller);
    ImGui::TextDisabled("Kept for the next start.");
}

}  // namespace lucarne::viewer
