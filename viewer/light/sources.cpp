// Panels of light sources other than lamps: the sun, the sky and emitting classes of points.
#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "gi/scene/colour_map.h"
#include "gi/scene/sky_model.h"
#include "viewer/light/day.h"
#include "viewer/light/edits.h"
#include "viewer/light/lighting.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

bool edit_degrees(const char* label, double& value, double least, double most, const char* format = "%.1f°") {
    return ImGui::DragScalar(LeftLabel(label), ImGuiDataType_Double, &value, 0.1f, &least, &most, format,
                             ImGuiSliderFlags_AlwaysClamp);
}

bool edit_moment(gi::Moment& moment) {
    gi::LocalTime time = gi::local_time(moment);
    int date[3] = {time.year, time.month, time.day};
    bool changed = ImGui::DragInt3(LeftLabel("Date"), date, 0.1f);
    float hours = static_cast<float>(time.seconds) / 3600;
    char clock[32];
    std::snprintf(clock, sizeof clock, "%02d:%02d", time.seconds / 3600, time.seconds / 60 % 60);
    if (ImGui::SliderFloat(LeftLabel("Time"), &hours, 0, 23.99f, clock, ImGuiSliderFlags_AlwaysClamp)) {
        time.seconds = static_cast<int>(std::lround(hours * 60)) * 60;
        changed = true;
    }
    float ahead = static_cast<float>(moment.ahead) / 60;
    if (ImGui::SliderFloat(LeftLabel("Clock"), &ahead, -12, 14, "UTC %+.1f h",
                           ImGuiSliderFlags_AlwaysClamp)) {
        moment.ahead = static_cast<int>(std::lround(ahead * 4)) * 15;
        changed = true;
    }
    if (!changed) return false;
    time.year = date[0], time.month = date[1], time.day = date[2];
    moment = gi::moment_of(time, moment.ahead);
    return true;
}

bool edit_share(const char* label, double& value, double least, double most) {
    return ImGui::SliderScalar(LeftLabel(label), ImGuiDataType_Double, &value, &least, &most, "%.2f",
                               ImGuiSliderFlags_AlwaysClamp);
}

glm::vec3 scaled_to_one(const glm::dvec3& colour, float& most) {
    most = static_cast<float>(std::max({colour.x, colour.y, colour.z}));
    return most > 0 ? glm::vec3(colour / static_cast<double>(most)) : glm::vec3(1.0f);
}

/// Edits a radiance as a colour and a strength.
bool edit_radiance(const char* label, glm::dvec3& radiance) {
    float most = 0;
    glm::vec3 colour = scaled_to_one(radiance, most);
    ImGui::PushID(label);
    bool changed = ImGui::ColorEdit3(LeftLabel("Linear colour"), &colour.x, ImGuiColorEditFlags_Float);
    changed |= ImGui::DragFloat(LeftLabel("Strength"), &most, std::max(most, 0.01f) / 100, 0, 1e9f,
                                "%.4g W/(sr m2)", ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();
    if (changed) radiance = glm::dvec3(colour) * static_cast<double>(most);
    return changed;
}

/// Replaces the scene's sky by an edited copy, because the sky is shared with the worker.
template <class Edit>
void change_sky(const Lighting& model, const Edit& edit) {
    auto sky = std::make_shared<gi::Environment>(*model.view.scene.environment);
    edit(*sky);
    model.view.scene.environment = std::move(sky);
    model.view.scene_changed();
}

void edit_even_sky(const Lighting& model) {
    glm::dvec3 radiance = model.view.scene.environment->scale;
    if (!edit_radiance("Sky", radiance)) return;
    change_sky(model, [&](gi::Environment& sky) {
        sky.scale = radiance;
        sky.texels = {glm::vec3(radiance)};
    });
}

void edit_clear_sky(const Lighting& model) {
    gi::SkySettings sky = *model.view.scene.environment->sky;
    bool changed = edit_share("Turbidity", sky.turbidity, gi::kLeastTurbidity, gi::kMostTurbidity);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("haze: 2 very clear, 3 clear, 6 hazy, 10 like thin fog");
    changed |= edit_share("Ground", sky.ground, 0, 1);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("albedo of the ground below the horizon");
    if (!gi::direction_to_sun(model.view.scene.lights))
        ImGui::TextDisabled("The scene has no sun to follow.");
    if (changed) set_clear_sky(model, sky);
}

/// Lets the user choose a sky picture, which a thread reads.
void choose_sky(LightModel& tools) {
    ImGui::SetNextItemWidth(-4 * ImGui::GetFontSize());
    const bool entered = ImGui::InputTextWithHint("##image", "sky.exr or sky.hdr", &tools.sky_image,
                                                  ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    if ((ImGui::Button("Load") || entered) && !tools.sky_image.empty())
        tools.commands.push(LoadSky{tools.sky_image});
    if (!tools.reading_sky.empty()) {
        // The progress is unknown: the bar moves back and forth.
        const auto seconds = static_cast<float>(ImGui::GetTime());
        ImGui::ProgressBar(0.5f - 0.5f * std::cos(3 * seconds), ImVec2(-FLT_MIN, 0),
                           ("reading " + tools.reading_sky).c_str());
    } else if (!tools.sky_problem.empty()) {
        ImGui::TextWrapped("%s", tools.sky_problem.c_str());
    }
}

void choose_class(gi::SceneMaterial& material, const Lighting& model) {
    const auto name_of = [](int number) {
        return std::to_string(number) + " " + std::string(gi::class_name(static_cast<uint8_t>(number)));
    };
    if (!ImGui::BeginCombo(LeftLabel("Class"), name_of(*material.classification).c_str())) return;
    for (int number = 0; number < 256; ++number)
        if (ImGui::Selectable(name_of(number).c_str(), number == *material.classification)) {
            material.classification = number;
            material.name = gi::class_name(static_cast<uint8_t>(number));
            model.view.scene_changed();
        }
    ImGui::EndCombo();
}

/// Draws the sky as seen from above, with the sun and its way through the day. Returns the moment to which
/// the mouse drags it.
std::optional<gi::SunMoment> edit_on_dial(const gi::SunMoment& moment) {
    const float radius = 4.5f * ImGui::GetFontSize(), rim = 1.25f * radius;
    const ImVec2 corner = ImGui::GetCursorScreenPos(), middle(corner.x + rim, corner.y + rim);
    const auto on_screen = [&](const glm::dvec2& place) {
        return ImVec2(middle.x + radius * static_cast<float>(place.x),
                      middle.y + radius * static_cast<float>(place.y));
    };
    ImGui::InvisibleButton("dial", ImVec2(2 * rim, 2 * rim));
    ImDrawList* canvas = ImGui::GetWindowDrawList();
    const ImU32 text = ImGui::GetColorU32(ImGuiCol_Text), pale = ImGui::GetColorU32(ImGuiCol_TextDisabled);
    const ImU32 golden = IM_COL32(255, 190, 60, 255);
    canvas->AddCircle(middle, radius, pale, 64);
    constexpr std::array kSides = {std::pair("N", glm::dvec2(0, -1)), std::pair("E", glm::dvec2(1, 0)),
                                   std::pair("S", glm::dvec2(0, 1)), std::pair("W", glm::dvec2(-1, 0))};
    for (const auto& [name, side] : kSides) {
        const ImVec2 size = ImGui::CalcTextSize(name), at = on_screen(1.13 * side);
        canvas->AddText(ImVec2(at.x - size.x / 2, at.y - size.y / 2), text, name);
    }
    const std::vector<SunOnDial> day = day_on_dial(moment);
    for (size_t i = 0; i + 1 < day.size(); ++i)
        if (day[i].elevation > 0 && day[i + 1].elevation > 0)
            canvas->AddLine(on_screen(day[i].place), on_screen(day[i + 1].place), golden, 2);
    const SunOnDial sun = on_dial(moment);
    const ImVec2 at = on_screen(sun.place / std::max(glm::length(sun.place), 1.0));
    if (sun.elevation > 0)
        canvas->AddCircleFilled(at, 0.4f * ImGui::GetFontSize(), golden);
    else
        canvas->AddCircle(at, 0.4f * ImGui::GetFontSize(), golden);
    if (ImGui::IsItemHovered() && !ImGui::IsItemActive())
        ImGui::SetTooltip("the sun's way through the day, seen from above; drag the sun along it");
    if (!ImGui::IsItemActive()) return std::nullopt;
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    return nearest_on_dial(day, {(mouse.x - middle.x) / radius, (mouse.y - middle.y) / radius})->moment;
}

}  // namespace

void draw_sun(const Lighting& model) {
    gi::SceneLight& light = *model.selected_light();
    if (ImGui::Checkbox("Daylight", &light.daylight)) model.view.scene_changed();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("strength and colour of the sun through the atmosphere (Preetham et al. 1999)");
    ImGui::SameLine();
    bool by_time = light.sun.has_value();
    if (ImGui::Checkbox("By place and time", &by_time))
        set_sun(model, by_time ? std::optional(gi::SunMoment{}) : std::nullopt);
    if (light.sun) {
        bool changed = edit_degrees("Latitude", light.sun->latitude, -90, 90, "%.4f°");
        changed |= edit_degrees("Longitude", light.sun->longitude, -180, 180, "%.4f°");
        changed |= edit_moment(light.sun->time);
        changed |= edit_degrees("True north", light.sun->north, -360, 360);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("direction of true north, clockwise from the scan's +y");
        if (const auto dragged = edit_on_dial(*light.sun); dragged && *dragged != *light.sun) {
            light.sun = dragged;
            changed = true;
        }
        if (changed) set_sun(model, light.sun);
        const gi::SolarPosition at = gi::solar_position(*light.sun);
        ImGui::Text("azimuth %.1f°, elevation %.1f°%s", at.azimuth, at.elevation,
                    at.elevation > 0 ? "" : ": it has set");
        return;
    }
    const glm::dvec3 to = light.position - light.target;
    double azimuth = std::atan2(to.x, to.y) / kDegree,
           elevation = std::atan2(to.z, std::hypot(to.x, to.y)) / kDegree;
    bool changed = edit_degrees("Azimuth", azimuth, -180, 180);
    changed |= edit_degrees("Elevation", elevation, -90, 90);
    if (!changed) return;
    light.target = light.position - gi::towards({azimuth, elevation}, 0);
    model.view.scene_changed();
}

void draw_sky(const Lighting& model) {
    if (!fold("Sky")) return;
    ImGui::PushID("sky");
    if (!model.view.scene.environment) {
        if (ImGui::Button("Even sky")) {
            auto sky = std::make_shared<gi::Environment>();
            sky->texels = {glm::vec3(1.0f)};
            model.view.scene.environment = std::move(sky);
            model.view.scene.environment_on = true;
            model.view.scene_changed();
        }
        ImGui::SameLine();
    } else {
        if (ImGui::Checkbox("On", &model.view.scene.environment_on)) model.view.scene_changed();
        ImGui::SameLine();
        if (ImGui::Button("Remove")) {
            model.view.scene.environment.reset();
            model.view.scene_changed();
        }
    }
    if (!model.view.scene.environment || !model.view.scene.environment->sky) {
        if (ImGui::Button("Sky from sun")) set_clear_sky(model, {});
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("the clear sky of the place and hour of the first sun (Preetham et al. 1999)");
    }
    if (model.view.scene.environment && model.view.scene.environment->sky) {
        edit_clear_sky(model);
    } else if (model.view.scene.environment) {
        if (model.view.scene.environment->image.empty())
            edit_even_sky(model);
        else
            ImGui::TextWrapped("%s", model.view.scene.environment->image.c_str());
        float degrees = static_cast<float>(model.view.scene.environment->rotation / kDegree);
        if (ImGui::SliderFloat(LeftLabel("Rotation"), &degrees, -180, 180, "%.1f°"))
            change_sky(model,
                       [&](gi::Environment& sky) { sky.rotation = static_cast<float>(degrees * kDegree); });
    }
    choose_sky(model.lights);
    ImGui::PopID();
}

void draw_emitters(const Lighting& model) {
    if (!fold("Emissive classes")) return;
    ImGui::PushID("emitters");
    for (size_t i = 0; i < model.view.scene.materials.size(); ++i) {
        gi::SceneMaterial& material = model.view.scene.materials[i];
        if (!material.classification) continue;
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Checkbox("##on", &material.emits)) model.view.scene_changed();
        ImGui::SameLine();
        choose_class(material, model);
        if (edit_radiance("Emission", material.emission)) model.view.scene_changed();
        const bool gone = ImGui::Button("Remove");
        ImGui::PopID();
        if (!gone) continue;
        model.view.scene.materials.erase(model.view.scene.materials.begin() + static_cast<ptrdiff_t>(i));
        model.view.scene_changed();
        break;
    }
    if (model.view.scene.materials.size() < 255 && ImGui::Button("Add a class")) {
        gi::SceneMaterial material;
        material.classification = 6;
        material.name = gi::class_name(6);
        material.emission = glm::dvec3(1);
        model.view.scene.materials.push_back(material);
        model.view.scene_changed();
    }
    ImGui::PopID();
}

}  // namespace lucarne::viewer
