#pragma once

#include <glm/vec3.hpp>

#include "gi/bounce_options.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::scenes {

/// A floor and three walls, all glossy, under a spot, lit by one bounce.
inline AnalyticScene glossy_corner(float exponent) {
    AnalyticScene scene;
    const glm::vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), o(0.0f);
    add_rectangle(scene.surfels, o, x, y, 120, glm::vec3(.7f));
    add_rectangle(scene.surfels, y, x, z, 120, glm::vec3(.7f));
    add_rectangle(scene.surfels, o, y, z, 120, glm::vec3(.6f, .1f, .1f));
    add_rectangle(scene.surfels, x, z, y, 120, glm::vec3(.1f, .5f, .1f));
    scene.materials = {material(.5f, .45f, exponent, 0)};
    scene.lights = {spot(glm::vec3(1.2f, .9f, 1.9f), glm::vec3(1.1f, 1.1f, 0), .8f, .7f, 10)};
    scene.camera = look(glm::vec3(1, -2, 1.2f), glm::vec3(1, 1, .9f), .5f, 64);
    scene.settings.set(kOnlyBounce, 1);
    return scene;
}

}  // namespace lucarne::gi::scenes
