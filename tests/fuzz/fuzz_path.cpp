#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/fuzz/fuzz.h"
#include "viewer/flythrough/path.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    const auto path = viewer::parse_path({reinterpret_cast<const char*>(data), size}, "fuzz");
    if (!path) return true;
    const size_t frames = std::min<size_t>(path->frames(), 100);
    for (size_t i = 0; i < frames; ++i) {
        const auto camera = path->at(path->start() + static_cast<double>(i) / path->frames_per_second);
        // A path that is accepted must give finite cameras.
        if (!std::isfinite(camera.position.x + camera.target.x + camera.up.x + camera.vertical_fov))
            std::abort();
    }
    return true;
}
