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
    const size_t frames = std::min<size_t>(path->frames(), 100);
    for (size_t i = 0; i < frames; ++i) {
        const double time = path->start() + static_cast<double>(i) / path->frames_per_second;
        const auto camera = path->at(time);
        // A path that is accepted must give finite cameras.
        if (!std::isfinite(camera.position.x + camera.target.x + camera.up.x + camera.vertical_fov))
            std::abort();
        if (i % 32 == 0) path->lights.light(scene, time);  // the sky takes long
        for (const auto& light : scene.lights)
            if (!std::isfinite(light.position.x + light.strength.x) || light.target == light.position)
                std::abort();
    }
    return true;
}
