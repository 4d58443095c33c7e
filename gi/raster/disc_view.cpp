#include "gi/raster/disc_view.h"

#include <array>

#include <glm/geometric.hpp>

namespace lucarne::gi {

void set_disc_view(const Program& program, const CameraView& view, const PointSize& size) {
    const auto axis = [&](std::string_view name, const glm::vec3& v, float w) {
        const std::array<float, 4> values = {v.x, v.y, v.z, w};
        program.set_block(name, values);
    };
    const glm::vec3 right(view.right.x, view.right.y, view.right.z), up(view.up.x, view.up.y, view.up.z);
    const float tan_x = glm::length(right), tan_y = glm::length(up);
    axis("view_right", right / tan_x, tan_x);
    axis("view_down", up / -tan_y, tan_y);
    axis("view_forward", {view.forward.x, view.forward.y, view.forward.z}, view.origin.w);
    axis("view_origin", {view.origin.x, view.origin.y, view.origin.z},
         view.projection == kOrthographic ? 1.0f : 0.0f);
    program.set_block("view_shift", std::array{view.right.w, view.up.w});
    program.set("view_width", view.width);
    program.set("view_height", view.height);
    program.set("point_scale", size.scale);
    program.set("point_pixels", size.pixels);
}

}  // namespace lucarne::gi
