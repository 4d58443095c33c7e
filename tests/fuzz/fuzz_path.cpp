#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/fuzz/fuzz.h"
#include "viewer/flythrough/path.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    using namespace viewer;
    const auto path = parse_path({reinterpret_cast<const char*>(data), size}, "fuzz");
    if (!path) return true;
    gi::Scene scene;
    for (const LightTrack& track : path->lights.lights) {
        gi::SceneLight light;
        light.kind = scene.lights.size() % 2 ? gi::LightKind::point : gi::LightKind::spot;
        light.name = track.name;
        scene.lights.push_back(std::move(light));
    }
    if (!path->lights.check(scene)) scene.lights.emplace_back().kind = gi::LightKind::directional;
    if (!path->lights.check(scene)) std::abort();
    const auto is_finite = [](const glm::dvec3& v) { return std::isfinite(v.x + v.y + v.z); };
    const gi::Scene base = scene;
    const size_t frames = std::min<size_t>(path->frames(), 100);
    for (size_t i = 0; i < frames; ++i) {
        const double time = path->start() + static_cast<double>(i) / path->frames_per_second;
        const auto camera = path->at(time);
        // A path that is accepted must give finite cameras.
        if (!is_finite(camera.position) || !is_finite(camera.target) || !is_finite(camera.up) ||
            !std::isfinite(camera.vertical_fov))
            std::abort();
        if (i % 32 == 0) path->lights.apply(base, time, scene);  // the sky takes long
        for (const auto& light : scene.lights)
            if (!is_finite(light.position) || !is_finite(light.target) || !is_finite(light.strength) ||
                light.target == light.position)
                std::abort();
    }
    return true;
}
