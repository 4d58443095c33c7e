// A large scan with a small finely scanned place, for tests of nested light views.
#pragma once

#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/lighting/light_view.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::scenes {

/// A yard of 60 cm with a wall and a board that stands upright, of points 1 cm apart, and 2 m beside it a
/// plain of 16 m.
inline SurfelCloud town() {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    std::vector<Surfel> surfels;
    add_rectangle(surfels, {-7.9f, 2, 0}, 15.8f * x, 5.9f * y, 20, glm::vec3(.5f));
    add_rectangle(surfels, {-.3f, -.3f, 0}, .6f * x, .6f * y, 60, {.5f, .6f, .2f});
    add_rectangle(surfels, {-.3f, .3f, 0}, .6f * x, .3f * z, 60, {.7f, .5f, .9f});
    add_rectangle(surfels, {-.25f, -.1f, 0}, .4f * x, .25f * z, 30, glm::vec3(.4f));
    return SurfelCloud(std::move(surfels), {{-8, -8, -8}, 16}, 64);
}
inline Bounds town_bounds() {
    return {glm::vec3(-8), glm::vec3(8)};
}
inline CameraView seen_town(uint32_t side) {
    return gi::look({.25f, -.7f, .45f}, {0, .1f, .05f}, side, side, .6f);
}

}  // namespace lucarne::gi::scenes
