#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <imgui.h>

#include "viewer/style/look_edits.h"
#include "viewer/style/styling.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

/// Draws a choice of names. Returns true if another one was chosen.
template <class Value>
bool choice(const char* label, Value& value, std::span<const std::string_view> names) {
    bool changed = false;
    const std::string now(names[static_cast<size_t>(value)]);
    if (!ImGui::BeginCombo(LeftLabel(label), now.c_str())) return false;
    for (size_t i = 0; i < names.size(); ++i) {
        const std::string name(names[i]);
        if (!ImGui::Selectable(name.c_str(), name == now)) continue;
        value = static_cast<Value>(i);
        changed = true;
    }
    ImGui::EndCombo();
    return changed;
}

bool slider(const char* label, double& value, float least, float most, const char* format, int flags = 0) {
    float shown = static_cast<float>(value);
    if (!ImGui::SliderFloat(LeftLabel(label), &shown, least, most, format,
                            flags | ImGuiSliderFlags_AlwaysClamp))
        return false;
    value = shown;
    return true;
}

bool attribute_choice(const Styling& model, gi::Look& look) {
    if (!model.view.picture || !model.view.picture->source ||
        !ImGui::BeginCombo(LeftLabel("Attribute"), look.attribute.c_str()))
        return false;
    bool changed = false;
    for (const std::string& name : attribute_names(*model.view.picture->source)) {
        if (!ImGui::Selectable(name.c_str(), name == look.attribute)) continue;
        look.attribute = name;
        look.range.reset();
        changed = true;
    }
    ImGui::EndCombo();
    return changed;
}

bool edit_range(const Styling& model, gi::Look& look) {
    const auto& measured = model.view.picture ? model.view.picture->values.range : std::nullopt;
    bool automatic = !look.range;
    bool changed = ImGui::Checkbox("Range where most values lie", &automatic);
    if (changed) look.range = automatic ? std::nullopt : std::optional(measured.value_or(gi::ValueRange{}));
    if (!measured) {
        ImGui::TextDisabled("no point has this attribute");
        return changed;
    }
    // Dragging an end by 200 pixels moves it by the size of the range.
    gi::ValueRange range = look.range.value_or(*measured);
    const auto speed = static_cast<float>(std::max(std::abs(range.high - range.low) / 200, 1e-9));
    bool dragged = ImGui::DragScalar(LeftLabel("Low"), ImGuiDataType_Double, &range.low, speed, nullptr,
                                     nullptr, "%.6g");
    dragged |= ImGui::DragScalar(LeftLabel("High"), ImGuiDataType_Double, &range.high, speed, nullptr,
                                 nullptr, "%.6g");
    if (dragged) look.range = range;
    return changed || dragged;
}

bool edit_colours(const Styling& model, gi::Look& look) {
    bool changed = choice("Colour", look.colour, gi::colour_names());
    if (changed) look.range.reset();
    if (look.colour == gi::ColourBy::attribute) changed |= attribute_choice(model, look);
    if (!gi::has_range(look.colour)) return changed;
    changed |= choice("Colour map", look.map, gi::colour_map_names());
    changed |= ImGui::Checkbox("Reversed", &look.reversed);
    return edit_range(model, look) || changed;
}

/// How strictly outliers are left out.
bool edit_outliers(gi::Look& look) {
    constexpr const char* kNames[] = {"All drawn", "Without those found", "Strict", "Very strict"};
    int strictness = static_cast<int>(std::min<uint32_t>(look.outliers, 3));
    if (!ImGui::SliderInt(LeftLabel("Outliers"), &strictness, 0, 3, kNames[strictness],
                          ImGuiSliderFlags_AlwaysClamp))
        return false;
    look.outliers = static_cast<uint32_t>(strictness);
    return true;
}

bool edit_size(gi::Look& look) {
    if (look.point_pixels > 0) return slider("Size", look.point_pixels, 1, 20, "%.1f pixels");
    return slider("Size", look.point_size, 0.1f, 5, "x %.2f", ImGuiSliderFlags_Logarithmic);
}

/// How points are drawn, beyond their size and colour.
bool edit_points(gi::Look& look) {
    if (!fold("More")) return false;
    bool changed = edit_outliers(look);
    help_mark("points that lie on no surface, as of dust, rain or glass");
    bool fixed = look.point_pixels > 0;
    if (ImGui::Checkbox("Fixed point size", &fixed)) {
        look.point_pixels = fixed ? 3 : 0;
        changed = true;
    }
    help_mark("in pixels; otherwise each point is as large as the surface that it stands for");
    if (look.point_pixels > 0) return changed;
    bool blended = !look.single_discs;
    if (ImGui::Checkbox("Blended surfaces", &blended)) {
        look.single_discs = !blended;
        changed = true;
    }
    help_mark("discs that overlap are mixed, which hides their edges and the noise of colours");
    changed |= ImGui::Checkbox("Front sides only", &look.front_only);
    help_mark("points that face away from the camera are not drawn: rooms are seen from outside");
    bool filled = !look.open_holes;
    if (ImGui::Checkbox("Filled holes", &filled)) {
        look.open_holes = !filled;
        changed = true;
    }
    help_mark("small holes of the scan that the conversion has filled, as below the scanner");
    return changed;
}

bool edit_shading(const Styling& model, gi::Look& look) {
    bool lit = is_lit(model);
    if (ImGui::Checkbox("Lighting", &lit)) switch_light(model);
    if (lit) return false;
    bool changed = choice("Shading", look.unlit.shading, gi::shading_names());
    if (look.unlit.shading != gi::Shading::flat)
        changed |= slider("Strength", look.unlit.strength, 0, 5, "%.2f");
    if (look.colour == gi::ColourBy::colour)
        changed |=
            slider("Brightness", look.unlit.brightness, .25f, 8, "x %.2f", ImGuiSliderFlags_Logarithmic);
    return changed;
}

bool edit_backdrop(gi::Look& look) {
    static constexpr std::array<std::string_view, 3> kKinds = {"From scene", "One colour",
                                                               "From top to bottom"};
    gi::Backdrop& backdrop = look.backdrop;
    bool changed = choice("Background", backdrop.kind, kKinds);
    const auto colour = [&](const char* label, glm::dvec3& value) {
        float shown[3] = {static_cast<float>(value.x), static_cast<float>(value.y),
                          static_cast<float>(value.z)};
        if (!ImGui::ColorEdit3(LeftLabel(label), shown, ImGuiColorEditFlags_Float)) return;
        value = glm::clamp(glm::dvec3(shown[0], shown[1], shown[2]), 0.0, 1.0);
        changed = true;
    };
    if (backdrop.kind != gi::Backdrop::Kind::scene) colour("Top", backdrop.top);
    if (backdrop.kind == gi::Backdrop::Kind::gradient) colour("Bottom", backdrop.bottom);
    return changed;
}

bool edit_classes(const Styling& model, gi::Look& look) {
    if (!model.view.picture || model.view.picture->values.classes.none() || !ImGui::TreeNode("Classes"))
        return false;
    bool changed = false;
    for (size_t number = 0; number < 256; ++number) {
        if (!model.view.picture->values.classes[number] && !look.hidden_classes[number]) continue;
        const auto small = static_cast<uint8_t>(number);
        const glm::vec3 c = gi::class_colour(small);
        bool shown = !look.hidden_classes[number];
        const std::string label = fmt::format("{} {}", number, gi::class_name(small));
        ImGui::ColorButton(fmt::format("##{}", number).c_str(), ImVec4(c.x, c.y, c.z, 1),
                           ImGuiColorEditFlags_NoTooltip);
        ImGui::SameLine();
        if (!ImGui::Checkbox(label.c_str(), &shown)) continue;
        look.hidden_classes[number] = !shown;
        changed = true;
    }
    ImGui::TreePop();
    return changed;
}

bool drag_place(const char* label, glm::dvec3& place, double speed) {
    double values[3] = {place.x, place.y, place.z};
    if (!ImGui::DragScalarN(LeftLabel(label), ImGuiDataType_Double, values, 3, static_cast<float>(speed),
                            nullptr, nullptr, "%.3f"))
        return false;
    place = {values[0], values[1], values[2]};
    return true;
}

/// Draws the fields of a clip box. Returns true if the box was changed. Sets `gone` if it is to be removed.
bool edit_box(gi::ClipBox& box, double speed, bool& gone) {
    bool changed = drag_place("From", box.min, speed);
    changed |= drag_place("To", box.max, speed);
    box.max = glm::max(box.min, box.max);
    double degrees = box.rotation * 180 / std::numbers::pi;
    if (slider("Rotation", degrees, -180, 180, "%.1f°")) {
        box.rotation = degrees * std::numbers::pi / 180;
        changed = true;
    }
    changed |= ImGui::Checkbox("Invert", &box.inverted);
    ImGui::SameLine();
    gone = ImGui::SmallButton("Remove");
    return changed || gone;
}

bool edit_plane(gi::ClipPlane& plane, double speed, bool& gone) {
    bool changed = drag_place("At", plane.position, speed);
    glm::dvec3 normal = plane.normal;
    if (drag_place("Normal", normal, 0.01) && glm::dot(normal, normal) > 1e-6) {
        plane.normal = normal;
        changed = true;
    }
    changed |= ImGui::Checkbox("Keeps the other side", &plane.inverted);
    ImGui::SameLine();
    gone = ImGui::SmallButton("Remove");
    return changed || gone;
}

template <class Shapes>
bool edit_shapes(const char* name, Shapes& shapes, const auto& edit) {
    bool changed = false;
    for (size_t i = 0; i < shapes.size(); ++i) {
        ImGui::PushID(name);
        ImGui::PushID(static_cast<int>(i));
        bool gone = false;
        if (ImGui::TreeNodeEx("shape", ImGuiTreeNodeFlags_DefaultOpen, "%s %d", name,
                              static_cast<int>(i) + 1)) {
            changed |= edit(shapes[i], gone);
            ImGui::TreePop();
        }
        ImGui::PopID();
        ImGui::PopID();
        if (gone) shapes.erase(shapes.begin() + static_cast<ptrdiff_t>(i--));
    }
    return changed;
}

bool edit_clip(const Styling& model, gi::Clip& clip) {
    if (!ImGui::TreeNode("Clip")) return false;
    if (ImGui::Button("Add box")) add_clip_box(model);
    ImGui::SameLine();
    if (ImGui::Button("Add plane")) add_clip_plane(model);
    ImGui::SameLine();
    ImGui::Checkbox("Handles", &model.look.show_handles);
    const double speed = model.view.scene_size / 1000;
    bool changed =
        edit_shapes("box", clip.boxes, [&](auto& box, bool& gone) { return edit_box(box, speed, gone); });
    changed |= edit_shapes("plane", clip.planes,
                           [&](auto& plane, bool& gone) { return edit_plane(plane, speed, gone); });
    if (clip.active()) changed |= ImGui::Checkbox("What is clipped still casts shadows", &clip.casts);
    ImGui::TreePop();
    return changed;
}

}  // namespace

void draw_look_panel(const Styling& model) {
    gi::Look& look = model.view.scene.look;
    bool changed = edit_colours(model, look);
    changed |= edit_size(look);
    changed |= edit_shading(model, look);
    changed |= edit_backdrop(look);
    // These are drawn over the picture; the picture need not be made again.
    ImGui::Checkbox("Legend", &look.legend);
    ImGui::SameLine();
    ImGui::Checkbox("Axes", &look.axes);
    ImGui::SameLine();
    ImGui::Checkbox("Scale bar", &look.scale_bar);
    changed |= edit_classes(model, look);
    changed |= edit_clip(model, look.clip);
    changed |= edit_points(look);
    if (changed) model.view.scene_changed();
}

}  // namespace lucarne::viewer
