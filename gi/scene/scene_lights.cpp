#include "gi/scene/scene_lights.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "gi/scene/degrees.h"
#include "gi/scene/scene_limits.h"
#include "gi/scene/sky_model.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;

constexpr JsonRange kConeDegrees{.1, 170}, kCapDegrees{0, 90}, kSide{1e-6, 1e9}, kTurnDegrees{-360, 360},
    kLatitude{-90, 90}, kLongitude{-180, 180}, kTurbidity{kLeastTurbidity, kMostTurbidity};

/// Reads where a light shines to: `target`, or `direction` from its position.
Result<void> read_aim(JsonObject& object, SceneLight& light) {
    const bool by_direction = object.has("direction");
    if (by_direction && object.has("target"))
        return object.wrong("give a target or a direction, not both", "direction");
    if (by_direction) {
        LUCARNE_ASSIGN(const dvec3 direction, object.vector("direction", kCoordinate));
        light.target = light.position + direction;
    } else {
        LUCARNE_ASSIGN(light.target, object.vector("target", kCoordinate));
    }
    if (light.target == light.position)
        return object.wrong("the light points nowhere", by_direction ? "direction" : "target");
    return {};
}

Result<void> read_spot(JsonObject& object, SceneLight& light) {
    LUCARNE_ASSIGN(light.position, object.vector("position", kCoordinate));
    LUCARNE_TRY(read_aim(object, light));
    LUCARNE_ASSIGN(light.angle, object.number("angle", kConeDegrees, 60));
    light.angle = glm::radians(light.angle);
    LUCARNE_ASSIGN(light.softness, object.number("softness", kShare, .1));
    LUCARNE_ASSIGN(light.strength, object.vector("intensity", kRadiance));
    return {};
}

Result<void> read_point(JsonObject& object, SceneLight& light) {
    LUCARNE_ASSIGN(light.position, object.vector("position", kCoordinate));
    light.target = light.position - dvec3(0, 0, 1);
    LUCARNE_ASSIGN(light.strength, object.vector("intensity", kRadiance));
    return {};
}

Result<SunMoment> read_sun(JsonObject object) {
    SunMoment sun;
    LUCARNE_ASSIGN(sun.latitude, object.number("latitude", kLatitude));
    LUCARNE_ASSIGN(sun.longitude, object.number("longitude", kLongitude));
    LUCARNE_ASSIGN(const std::string time, object.text("time"));
    const auto moment = parse_time(time);
    if (!moment) return object.wrong(moment.error().line(), "time");
    sun.time = *moment;
    LUCARNE_ASSIGN(sun.north, object.number("north", kTurnDegrees, 0));
    LUCARNE_TRY(object.finish());
    return sun;
}

Result<void> read_directional(JsonObject& object, SceneLight& light) {
    LUCARNE_ASSIGN(const auto sun, object.object("sun"));
    if (sun) {
        if (object.has("direction"))
            return object.wrong("give a direction or the sun's place and time, not both", "direction");
        LUCARNE_ASSIGN(light.sun, read_sun(*sun));
        follow_sun(light);
    } else {
        LUCARNE_ASSIGN(light.target, object.vector("direction", kCoordinate));
        if (light.target == dvec3(0)) return object.wrong("the light points nowhere", "direction");
    }
    light.daylight = !object.has("irradiance");
    const double usual = light.daylight ? degrees_of(kSunRadius) : 0;
    LUCARNE_ASSIGN(light.angular_radius, object.number("angular_radius", kCapDegrees, usual));
    light.angular_radius = glm::radians(light.angular_radius);
    LUCARNE_ASSIGN(light.strength, object.vector("irradiance", kRadiance, dvec3(0)));
    return {};
}

Result<void> read_rectangle(JsonObject& object, SceneLight& light) {
    LUCARNE_ASSIGN(light.position, object.vector("position", kCoordinate));
    LUCARNE_TRY(read_aim(object, light));
    LUCARNE_ASSIGN(light.width, object.number("width", kSide));
    LUCARNE_ASSIGN(light.height, object.number("height", kSide));
    LUCARNE_ASSIGN(light.up, object.vector("up", kCoordinate, dvec3(0, 0, 1)));
    LUCARNE_ASSIGN(light.strength, object.vector("radiance", kRadiance));
    return {};
}

Result<void> read_disc(JsonObject& object, SceneLight& light) {
    LUCARNE_ASSIGN(light.position, object.vector("position", kCoordinate));
    LUCARNE_TRY(read_aim(object, light));
    LUCARNE_ASSIGN(light.radius, object.number("radius", kSide));
    LUCARNE_ASSIGN(light.strength, object.vector("radiance", kRadiance));
    return {};
}

Result<SkySettings> read_sky(JsonObject object, const std::optional<dvec3>& sun) {
    SkySettings sky;
    LUCARNE_ASSIGN(sky.turbidity, object.number("turbidity", kTurbidity, sky.turbidity));
    LUCARNE_ASSIGN(sky.ground, object.number("ground", kShare, sky.ground));
    if (sun && object.has("direction"))
        return object.wrong("the scene's directional light is the sun; leave this out", "direction");
    if (!sun && !object.has("direction"))
        return object.wrong("give the direction of its sun's light, or a directional light as its sun");
    LUCARNE_ASSIGN(const dvec3 direction, object.vector("direction", kCoordinate, -sun.value_or(dvec3(0))));
    if (direction == dvec3(0)) return object.wrong("the light comes from nowhere", "direction");
    // A unit direction stays as it is, so that a scene that was written is read back the same.
    const bool unit = std::abs(glm::dot(direction, direction) - 1) < 1e-12;
    sky.sun = sun ? *sun : unit ? -direction : -glm::normalize(direction);
    LUCARNE_TRY(object.finish());
    return sky;
}

}  // namespace

void follow_sun(SceneLight& light) {
    if (light.sun) light.target = light.position - towards(solar_position(*light.sun), light.sun->north);
}

bool shines(const SceneLight& light) {
    return light.on && !(light.sun && light.target.z >= light.position.z);
}

Result<SceneLight> read_light(JsonObject object) {
    // In the order of LightKind.
    static constexpr Result<void> (*kReaders[])(JsonObject&, SceneLight&) = {
        read_spot, read_point, read_directional, read_rectangle, read_disc};
    SceneLight light;
    LUCARNE_ASSIGN(const size_t kind,
                   object.choice("type", {"spot", "point", "directional", "rectangle", "disc"}));
    light.kind = static_cast<LightKind>(kind);
    LUCARNE_ASSIGN(light.name, object.text("name", ""));
    LUCARNE_ASSIGN(light.on, object.boolean("on", true));
    LUCARNE_TRY(kReaders[kind](object, light));
    LUCARNE_TRY(object.finish());
    return light;
}

Result<std::shared_ptr<const Environment>> read_environment(JsonObject object,
                                                            const std::filesystem::path& folder,
                                                            const std::optional<dvec3>& sun) {
    auto environment = std::make_shared<Environment>();
    LUCARNE_ASSIGN(const auto sky, object.object("sky"));
    if (sky) {
        LUCARNE_ASSIGN(environment->sky, read_sky(*sky, sun));
        LUCARNE_TRY(object.finish());
        return environment;
    }
    LUCARNE_ASSIGN(const std::string image, object.text("image", ""));
    if (image.empty() && !object.has("radiance")) return object.wrong("give a sky, a radiance or an image");
    LUCARNE_ASSIGN(const dvec3 radiance, object.vector("radiance", kRadiance, dvec3(1)));
    LUCARNE_ASSIGN(const double rotation, object.number("rotation", kTurnDegrees, 0));
    LUCARNE_TRY(object.finish());
    environment->texels = {glm::vec3(radiance)};
    environment->scale = radiance;
    environment->rotation = static_cast<float>(glm::radians(rotation));
    if (!image.empty()) {
        auto loaded = load_environment(folder / image, radiance, glm::radians(rotation));
        if (!loaded) return object.wrong(loaded.error().line(), "image");
        *environment = std::move(*loaded);
    }
    return environment;
}

}  // namespace lucarne::gi
