#include "gi/raster/disc_view.h"

#include <array>

#include <glm/geometric.hpp>

namespace lucarne::gi {

DiscView disc_view(const CameraView& view, const PointSize& size) {
    const glm::vec3 right(view.right.x, view.right.y, view.right.z), up(view.up.x, view.up.y, view.up.z);
    const float tan_x = glm::length(right), tan_y = glm::length(up);
    return {.right = {right / tan_x, tan_x},
            .down = {up / -tan_y, tan_y},
            .forward = {view.forward.x, view.forward.y, view.forward.z, view.origin.w},
            .origin = {view.origin.x, view.origin.y, view.origin.z,
                       view.projection == kOrthographic ? 1.0f : 0.0f},
            .shift = {view.right.w, view.up.w},
            .width = view.width,
            .height = view.height,
            .size = size};
}

void set_disc_view(const Program& program, const CameraView& view, const PointSize& size) {
    const DiscView uniforms = disc_view(view, size);
    const auto axis = [&](std::string_view name, const glm::vec4& v) {
        program.set_block(name, std::array{v.x, v.y, v.z, v.w});
    };
    axis("view_right", uniforms.right);
    axis("view_down", uniforms.down);
    axis("view_forward", uniforms.forward);
    axis("view_origin", uniforms.origin);
    program.set_block("view_shift", std::array{uniforms.shift.x, uniforms.shift.y});
    program.set("view_width", view.width);
    program.set("view_height", view.height);
    program.set("point_scale", size.scale);
    program.set("point_pixels", size.pixels);
    program.set("point_most", size.most);
    program.set("point_front_only", size.front_only ? 1u : 0u);
}

}  // namespace lucarne::gi
