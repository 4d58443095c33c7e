#include "gi/device/gl/layered_target.h"

#include <algorithm>
#include <string>
#include <vector>

#include <epoxy/gl.h>
#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

/// Draws triangles that cover the whole of a layer: number i into layer i % 3. Attributes: a number, and
/// four.
class LayeredTargetTest : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        device->add_shader("test/layers.vert", R"(
            flat out int number;
            void main() { number = gl_VertexID / 3; gl_Position = vec4(0.0); })");
        device->add_shader("test/layers.geom", R"(
            layout(triangles) in;
            layout(triangle_strip, max_vertices = 3) out;
            flat in int number[];
            flat out float value;
            void main() {
                for (int i = 0; i < 3; ++i) {
                    value = float(number[0] + 1);
                    gl_Layer = number[0] % 3;
                    gl_Position = vec4(i == 1 ? 3.0 : -1.0, i == 2 ? 3.0 : -1.0, 0.0, 1.0);
                    EmitVertex();
                }
            })");
        device->add_shader("test/layers.frag", R"(
            flat in float value;
            uniform float scale;
            layout(location = 0) out float largest;
            layout(location = 1) out vec4 sum;
            void main() { largest = -10.0 + value * scale; sum = vec4(1.0, value, -value, gl_FragCoord.x); })");
        device->add_shader("test/read.comp", R"(
            layout(local_size_x = 1) in;
            layout(binding = 0) uniform sampler3D picture;
            layout(std430, binding = 0) buffer Values { vec4 values[]; };
            uniform int width, height;
            void main() {
                ivec3 at = ivec3(gl_GlobalInvocationID);
                values[(at.z * height + at.y) * width + at.x] = texelFetch(picture, at, 0);
            })");
    }
    Result<const RasterProgram*> program() const {
        return device->raster_program({"test/layers.vert", "test/layers.geom", "test/layers.frag"});
    }
    std::vector<glm::vec4> read(const LayeredTarget& target, size_t attribute) {
        const auto size = glm::uvec3(target.size());
        const auto reader = device->program("test/read.comp");
        EXPECT_TRUE(reader) << reader.error().line();
        const size_t cells = size_t{size.x} * size.y * size.z;
        auto values = device->buffer(cells * sizeof(glm::vec4), "values");
        target.bind_texture(attribute, 0);
        values->bind(0);
        (*reader)->set("width", target.size().x);
        (*reader)->set("height", target.size().y);
        (*reader)->dispatch(size.x, size.y, size.z);
        return values->download_all<glm::vec4>(cells);
    }
    static std::vector<TargetAttribute> attributes(uint32_t bits) {
        return {{1, bits, TargetBlend::max}, {4, bits, TargetBlend::add}};
    }
};

TEST_F(LayeredTargetTest, TrianglesAreAddedOrTheLargestIsKeptInEachLayer) {
    const auto drawn = program();
    ASSERT_TRUE(drawn) << drawn.error().line();
    (*drawn)->set("scale", 2.0f);
    for (const uint32_t bits : {16u, 32u}) {
        auto target = LayeredTarget::create(*device, {5, 4, 3}, attributes(bits), "test");
        ASSERT_TRUE(target) << target.error().line();
        target->clear();
        target->draw(**drawn, 0, 3 * 7);  // numbers 0 to 6: layer 0 gets 0, 3 and 6
        const auto largest = read(*target, 0), sum = read(*target, 1);
        for (size_t i = 0; i < sum.size(); ++i) {
            const size_t layer = i / 20, x = i % 5;
            EXPECT_FLOAT_EQ(largest[i].x, std::max(0.0f, -10 + 2 * (layer == 0   ? 7.0f
                                                                    : layer == 1 ? 5.0f
                                                                                 : 6.0f)));
            const float count = layer == 0 ? 3 : 2, values = layer == 0 ? 12 : layer == 1 ? 7 : 9;
            EXPECT_EQ(sum[i], glm::vec4(count, values, -values, count * (static_cast<float>(x) + .5f)));
        }
        target->clear();
        target->draw(**drawn, 3 * 4, 3);  // number 4 alone
        const auto one = read(*target, 1);
        for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].y, i / 20 == 1 ? 5 : 0);
    }
}

TEST_F(LayeredTargetTest, DrawingLeavesTheStateAsItWas) {
    const auto drawn = program();
    ASSERT_TRUE(drawn) << drawn.error().line();
    (*drawn)->set("scale", 1.0f);
    auto target = LayeredTarget::create(*device, {5, 4, 3}, attributes(32), "test");
    ASSERT_TRUE(target) << target.error().line();
    target->clear();
    GLuint framebuffer = 0, vertex_array = 0;
    glCreateFramebuffers(1, &framebuffer);
    glCreateVertexArrays(1, &vertex_array);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glBindVertexArray(vertex_array);
    glViewport(1, 2, 3, 2);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT_AND_BACK);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, 1, 1);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glDisablei(GL_BLEND, 1);
    glBlendEquation(GL_FUNC_REVERSE_SUBTRACT);
    glBlendFuncSeparate(GL_DST_COLOR, GL_SRC_ALPHA, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    target->draw(**drawn, 0, 9);
    for (const glm::vec4& sum : read(*target, 1)) EXPECT_EQ(sum.x, 1) << "other state disturbed the drawing";
    const auto integer = [](GLenum name) {
        GLint values[4] = {};
        glGetIntegerv(name, values);
        return values[0];
    };
    EXPECT_EQ(integer(GL_DRAW_FRAMEBUFFER_BINDING), static_cast<GLint>(framebuffer));
    EXPECT_EQ(integer(GL_VERTEX_ARRAY_BINDING), static_cast<GLint>(vertex_array));
    EXPECT_EQ(integer(GL_POLYGON_MODE), static_cast<GLint>(GL_LINE));
    EXPECT_EQ(integer(GL_BLEND_EQUATION_RGB), static_cast<GLint>(GL_FUNC_REVERSE_SUBTRACT));
    EXPECT_EQ(integer(GL_BLEND_SRC_RGB), static_cast<GLint>(GL_DST_COLOR));
    EXPECT_EQ(integer(GL_BLEND_DST_ALPHA), static_cast<GLint>(GL_ONE_MINUS_SRC_ALPHA));
    for (const GLenum on : {GL_CULL_FACE, GL_SCISSOR_TEST, GL_DEPTH_TEST}) EXPECT_TRUE(glIsEnabled(on));
    EXPECT_TRUE(glIsEnabledi(GL_BLEND, 0));
    EXPECT_FALSE(glIsEnabledi(GL_BLEND, 1));
    GLboolean mask[4] = {};
    glGetBooleani_v(GL_COLOR_WRITEMASK, 1, mask);
    EXPECT_TRUE(mask[0] && !mask[1] && mask[2] && !mask[3]);
    GLint viewport[4] = {};
    glGetIntegerv(GL_VIEWPORT, viewport);
    EXPECT_EQ(std::vector<GLint>(viewport, viewport + 4), (std::vector<GLint>{1, 2, 3, 2}));
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteVertexArrays(1, &vertex_array);
}

TEST_F(LayeredTargetTest, MemoryCountsAgainstTheCapWhileTheTargetLives) {
    const uint64_t before = device->memory_used();
    {
        const auto target = LayeredTarget::create(*device, {8, 8, 8}, attributes(32), "test");
        ASSERT_TRUE(target);
        EXPECT_EQ(device->memory_used(), before + 512 * 20);
        device->set_memory_cap(device->memory_used() + 1000);
        const auto second = LayeredTarget::create(*device, {8, 8, 8}, attributes(16), "second");
        ASSERT_FALSE(second);
        EXPECT_EQ(second.error().what, "second");
    }
    EXPECT_EQ(device->memory_used(), before);
}

TEST_F(LayeredTargetTest, SizesBeyondTheDevicesLimitsAreAnError) {
    for (const glm::ivec3 size : {glm::ivec3(1 << 20, 1, 1), glm::ivec3(1, 1, 1 << 20)}) {
        const auto target = LayeredTarget::create(*device, size, attributes(32), "voxels");
        ASSERT_FALSE(target);
        EXPECT_NE(target.error().line().find("grid"), std::string::npos);
    }
}

TEST_F(LayeredTargetTest, ErrorsNameTheShaderThatDoesNotCompile) {
    device->add_shader("test/wrong.geom", "layout(triangles) in; void main() { nonsense; }");
    const auto wrong = device->raster_program({"test/layers.vert", "test/wrong.geom", "test/layers.frag"});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().what, "shader test/wrong.geom");
    EXPECT_FALSE(device->raster_program({"test/layers.vert", "test/none.geom", "test/layers.frag"}));
}

}  // namespace
}  // namespace lucarne::gi
