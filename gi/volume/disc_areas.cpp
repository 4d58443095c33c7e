#include "gi/volume/disc_areas.h"

#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::volume {

Octagon::Octagon(const glm::vec3& normal, float radius) {
    tracing::frame_of(normal, u, v);
    u *= radius;
    v *= radius;
}

Polygon octagon_about(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius) {
    const Octagon octagon(normal, radius / grid.voxel);
    const glm::vec3 middle = grid.place(position);
    Polygon polygon;
    for (int i = 0; i < 8; ++i) {
        // Corners of the square that the disc touches, cut off: (1, t), (t, 1), (-t, 1), ...
        const float long_side = i >= 4 ? -1.0f : 1.0f, short_side = long_side * Octagon::kTangent;
        const int k = i % 4;
        const float along = k == 0 ? long_side : k == 1 ? short_side : k == 2 ? -short_side : -long_side;
        const float across = k == 0 || k == 3 ? short_side : long_side;
        polygon.add(middle + octagon.u * along + octagon.v * across);
    }
    return polygon;
}

}  // namespace lucarne::gi::volume
