// The object `look` of a scene file.
#include "gi/scene/look_file.h"

#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "gi/scene/degrees.h"
#include "gi/scene/scene_limits.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;
using nlohmann::json;

// data/README.md states these limits.
constexpr JsonRange kSize{.05, 20}, kPixels{0, 64}, kStrength{0, 10}, kBrightness{.1, 10}, kReach{.1, 50},
    kDegrees{-360, 360};
constexpr JsonRange kValue{-1e300, 1e300};

template <class Names>
std::vector<std::string_view> list(const Names& names) {
    return {names.begin(), names.end()};
}

Result<ClipBox> read_box(JsonObject object) {
    ClipBox box;
    LUCARNE_ASSIGN(box.min, object.vector("min", kCoordinate));
    LUCARNE_ASSIGN(box.max, object.vector("max", kCoordinate));
    if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z)
        return object.wrong("lies below min", "max");
    LUCARNE_ASSIGN(const double degrees, object.number("rotation", kDegrees, 0));
    box.rotation = glm::radians(degrees);
    LUCARNE_ASSIGN(box.inverted, object.boolean("inverted", false));
    LUCARNE_TRY(object.finish());
    return box;
}

Result<ClipPlane> read_plane(JsonObject object) {
    ClipPlane plane;
    LUCARNE_ASSIGN(plane.position, object.vector("position", kCoordinate));
    LUCARNE_ASSIGN(plane.normal, object.vector("normal", kCoordinate));
    if (!(glm::length(plane.normal) > 0)) return object.wrong("points nowhere", "normal");
    LUCARNE_ASSIGN(plane.inverted, object.boolean("inverted", false));
    LUCARNE_TRY(object.finish());
    return plane;
}

Result<Clip> read_clip(JsonObject object) {
    Clip clip;
    LUCARNE_ASSIGN(const auto boxes, object.objects("boxes", kMostClips));
    for (const JsonObject& box : boxes) {
        LUCARNE_ASSIGN(ClipBox read, read_box(box));
        clip.boxes.push_back(read);
    }
    LUCARNE_ASSIGN(const auto planes, object.objects("planes", kMostClips - boxes.size()));
    for (const JsonObject& plane : planes) {
        LUCARNE_ASSIGN(ClipPlane read, read_plane(plane));
        clip.planes.push_back(read);
    }
    LUCARNE_ASSIGN(clip.casts, object.boolean("casts", false));
    LUCARNE_TRY(object.finish());
    return clip;
}

Result<Backdrop> read_backdrop(JsonObject object) {
    Backdrop backdrop;
    backdrop.kind = Backdrop::Kind::colour;
    if (object.has("bottom")) {
        backdrop.kind = Backdrop::Kind::gradient;
        LUCARNE_ASSIGN(backdrop.bottom, object.vector("bottom", kShare));
    }
    LUCARNE_ASSIGN(backdrop.top, object.vector("top", kShare));
    LUCARNE_TRY(object.finish());
    return backdrop;
}

Result<void> read_colours(JsonObject& object, Look& look) {
    LUCARNE_ASSIGN(const size_t by, object.choice("colour", list(colour_names()), 0));
    look.colour = static_cast<ColourBy>(by);
    const bool named = look.colour == ColourBy::attribute;
    LUCARNE_ASSIGN(look.attribute,
                   object.text("attribute", named ? std::nullopt : std::optional<std::string>("")));
    LUCARNE_ASSIGN(const size_t map, object.choice("map", list(colour_map_names()), 0));
    look.map = static_cast<ColourMap>(map);
    LUCARNE_ASSIGN(look.reversed, object.boolean("reversed", false));
    LUCARNE_ASSIGN(auto range, object.object("range"));
    if (range) {
        ValueRange values;
        LUCARNE_ASSIGN(values.low, range->number("low", kValue));
        LUCARNE_ASSIGN(values.high, range->number("high", kValue));
        LUCARNE_TRY(range->finish());
        look.range = values;
    }
    LUCARNE_ASSIGN(const auto hidden, object.integers("hidden_classes", 0, 255, 256));
    for (const int64_t number : hidden) look.hidden_classes.set(static_cast<size_t>(number));
    return {};
}

json vector_json(const dvec3& v) {
    return {v.x, v.y, v.z};
}

json write_clip(const Clip& clip) {
    json written = json::object();
    for (const ClipBox& box : clip.boxes) {
        json object = {{"min", vector_json(box.min)}, {"max", vector_json(box.max)}};
        if (box.rotation != 0) object["rotation"] = degrees_of(box.rotation);
        if (box.inverted) object["inverted"] = true;
        written["boxes"].push_back(object);
    }
    for (const ClipPlane& plane : clip.planes) {
        json object = {{"position", vector_json(plane.position)}, {"normal", vector_json(plane.normal)}};
        if (plane.inverted) object["inverted"] = true;
        written["planes"].push_back(object);
    }
    if (clip.casts) written["casts"] = true;
    return written;
}

}  // namespace

std::span<const std::string_view> colour_names() {
    static constexpr std::array<std::string_view, 9> kNames = {"colour",         "intensity",     "elevation",
                                                               "classification", "return-number", "scan",
                                                               "normal",         "attribute",     "clay"};
    return kNames;
}

std::span<const std::string_view> shading_names() {
    static constexpr std::array<std::string_view, 4> kNames = {"flat", "eye-dome", "occlusion", "relief"};
    return kNames;
}

bool has_range(ColourBy by) {
    return by == ColourBy::intensity || by == ColourBy::elevation || by == ColourBy::attribute;
}

bool same_colours(const Look& a, const Look& b) {
    return a.colour == b.colour && a.attribute == b.attribute && a.map == b.map && a.reversed == b.reversed &&
           a.range == b.range && a.hidden_classes == b.hidden_classes && a.outliers == b.outliers;
}

Result<Look> read_look(JsonObject object) {
    Look look;
    LUCARNE_TRY(read_colours(object, look));
    LUCARNE_ASSIGN(look.point_size, object.number("point_size", kSize, look.point_size));
    LUCARNE_ASSIGN(look.point_pixels, object.number("point_pixels", kPixels, look.point_pixels));
    LUCARNE_ASSIGN(const int64_t outliers, object.integer("outliers", 0, 3, look.outliers));
    look.outliers = static_cast<uint32_t>(outliers);
    LUCARNE_ASSIGN(look.single_discs, object.boolean("single_discs", false));
    LUCARNE_ASSIGN(look.front_only, object.boolean("front_only", false));
    LUCARNE_ASSIGN(look.open_holes, object.boolean("open_holes", false));
    LUCARNE_ASSIGN(const size_t shading,
                   object.choice("shading", list(shading_names()), static_cast<size_t>(look.unlit.shading)));
    look.unlit.shading = static_cast<Shading>(shading);
    LUCARNE_ASSIGN(look.unlit.strength, object.number("shading_strength", kStrength, look.unlit.strength));
    LUCARNE_ASSIGN(look.unlit.brightness, object.number("brightness", kBrightness, look.unlit.brightness));
    LUCARNE_ASSIGN(look.unlit.eye_dome_pixels,
                   object.number("eye_dome_pixels", kReach, look.unlit.eye_dome_pixels));
    LUCARNE_ASSIGN(look.unlit.occlusion_reach,
                   object.number("occlusion_reach", kReach, look.unlit.occlusion_reach));
    LUCARNE_ASSIGN(const auto backdrop, object.object("backdrop"));
    if (backdrop) {
        LUCARNE_ASSIGN(look.backdrop, read_backdrop(*backdrop));
    }
    LUCARNE_ASSIGN(const auto clip, object.object("clip"));
    if (clip) {
        LUCARNE_ASSIGN(look.clip, read_clip(*clip));
    }
    LUCARNE_ASSIGN(look.legend, object.boolean("legend", false));
    LUCARNE_ASSIGN(look.axes, object.boolean("axes", false));
    LUCARNE_ASSIGN(look.scale_bar, object.boolean("scale_bar", false));
    LUCARNE_TRY(object.finish());
    return look;
}

json write_look(const Look& look) {
    const Look plain;
    json written = json::object();
    const auto put = [&](const char* key, const auto& value, const auto& otherwise) {
        if (value != otherwise) written[key] = value;
    };
    if (look.colour != plain.colour) written["colour"] = colour_names()[static_cast<size_t>(look.colour)];
    put("attribute", look.attribute, plain.attribute);
    if (look.map != plain.map) written["map"] = colour_map_names()[static_cast<size_t>(look.map)];
    put("reversed", look.reversed, plain.reversed);
    if (look.range) written["range"] = {{"low", look.range->low}, {"high", look.range->high}};
    for (size_t number = 0; number < look.hidden_classes.size(); ++number)
        if (look.hidden_classes[number]) written["hidden_classes"].push_back(number);
    put("point_size", look.point_size, plain.point_size);
    put("point_pixels", look.point_pixels, plain.point_pixels);
    put("outliers", look.outliers, plain.outliers);
    put("single_discs", look.single_discs, plain.single_discs);
    put("front_only", look.front_only, plain.front_only);
    put("open_holes", look.open_holes, plain.open_holes);
    if (look.unlit.shading != plain.unlit.shading)
        written["shading"] = shading_names()[static_cast<size_t>(look.unlit.shading)];
    put("shading_strength", look.unlit.strength, plain.unlit.strength);
    put("brightness", look.unlit.brightness, plain.unlit.brightness);
    put("eye_dome_pixels", look.unlit.eye_dome_pixels, plain.unlit.eye_dome_pixels);
    put("occlusion_reach", look.unlit.occlusion_reach, plain.unlit.occlusion_reach);
    if (look.backdrop.kind != Backdrop::Kind::scene)
        written["backdrop"]["top"] = vector_json(look.backdrop.top);
    if (look.backdrop.kind == Backdrop::Kind::gradient)
        written["backdrop"]["bottom"] = vector_json(look.backdrop.bottom);
    if (look.clip != plain.clip) written["clip"] = write_clip(look.clip);
    put("legend", look.legend, plain.legend);
    put("axes", look.axes, plain.axes);
    put("scale_bar", look.scale_bar, plain.scale_bar);
    return written;
}

}  // namespace lucarne::gi
