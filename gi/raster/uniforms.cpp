#include "gi/raster/uniforms.h"

#include <array>
#include <string>

#include <glm/vec4.hpp>

namespace lucarne::gi {
namespace {

void set_member(const Program& program, std::string_view uniform, std::string_view member,
                const glm::vec4& v) {
    const std::array<float, 4> values = {v.x, v.y, v.z, v.w};
    program.set_block(std::string(uniform).append(member), values);
}

}  // namespace

void set(const Program& program, std::string_view uniform, const CameraView& view) {
    set_member(program, uniform, ".origin", view.origin);
    set_member(program, uniform, ".forward", view.forward);
    set_member(program, uniform, ".right", view.right);
    set_member(program, uniform, ".up", view.up);
    program.set(std::string(uniform).append(".width"), view.width);
    program.set(std::string(uniform).append(".height"), view.height);
    program.set(std::string(uniform).append(".projection"), view.projection);
}

void set(const Program& program, std::string_view uniform, const Light& light) {
    set_member(program, uniform, ".position", light.position);
    set_member(program, uniform, ".direction", light.direction);
    set_member(program, uniform, ".strength", light.strength);
    set_member(program, uniform, ".extent", light.extent);
    program.set(std::string(uniform).append(".kind"), light.kind);
    program.set(std::string(uniform).append(".nested"), light.nested);
}

}  // namespace lucarne::gi
