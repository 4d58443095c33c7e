#include "gi/device/gl/layered_target.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <utility>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "gi/device/gl/kept_state.h"

namespace lucarne::gi {
namespace {

constexpr const char* kLessMemory = "choose a smaller grid, 16 bits or fewer attributes";

GLenum format_of(const TargetAttribute& attribute) {
    if (attribute.components == 1) return attribute.bits == 16 ? GL_R16F : GL_R32F;
    return attribute.bits == 16 ? GL_RGBA16F : GL_RGBA32F;
}

}  // namespace

Result<LayeredTarget> LayeredTarget::create(Device& device, const glm::ivec3& size,
                                            std::span<const TargetAttribute> attributes,
                                            std::string_view what) {
    assert(!attributes.empty() && attributes.size() <= kMostAttributes);
    const std::string name(what);
    GLint layers = 0, side = 0, draw_buffers = 0;
    glGetIntegerv(GL_MAX_FRAMEBUFFER_LAYERS, &layers);
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &side);
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &draw_buffers);
    const int most = std::min(layers, side);
    if (size.x > side || size.y > side || size.z > most)
        return failed(name, fmt::format("the device draws no more than {} layers of {}x{}", most, side, side),
                      "choose a smaller grid");
    if (attributes.size() > static_cast<size_t>(draw_buffers))
        return failed(name, fmt::format("the device draws no more than {} attributes at once", draw_buffers),
                      "choose fewer");
    uint64_t bytes = 0;
    for (const TargetAttribute& attribute : attributes) bytes += attribute.bytes();
    bytes *= static_cast<uint64_t>(size.x) * static_cast<uint64_t>(size.y) * static_cast<uint64_t>(size.z);
    if (auto taken = device.take_memory(bytes, what); !taken) {
        Error error = std::move(taken).error();
        error.todo = kLessMemory;
        return tl::make_unexpected(std::move(error));
    }
    LayeredTarget target;
    target.device_ = &device;
    target.bytes_ = bytes;
    target.size_ = size;
    target.attributes_.assign(attributes.begin(), attributes.end());
    while (glGetError() != GL_NO_ERROR) {
    }
    glCreateVertexArrays(1, &target.vertex_array_);
    glCreateFramebuffers(1, &target.framebuffer_);
    std::array<GLenum, kMostAttributes> buffers{};
    for (size_t i = 0; i < attributes.size(); ++i) {
        GLuint& texture = target.textures_.emplace_back(0);
        glCreateTextures(GL_TEXTURE_3D, 1, &texture);
        glTextureStorage3D(texture, 1, format_of(attributes[i]), size.x, size.y, size.z);
        glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        buffers[i] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
        glNamedFramebufferTexture(target.framebuffer_, buffers[i], texture, 0);
    }
    glNamedFramebufferDrawBuffers(target.framebuffer_, static_cast<GLsizei>(attributes.size()),
                                  buffers.data());
    if (glGetError() != GL_NO_ERROR)
        return failed(name, fmt::format("the device has no {} KiB of memory left", (bytes + 1023) >> 10),
                      kLessMemory);
    if (glCheckNamedFramebufferStatus(target.framebuffer_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return failed(name, "the device cannot draw into layers of these formats", "choose --by area");
    return target;
}

LayeredTarget::LayeredTarget(LayeredTarget&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      size_(other.size_),
      attributes_(std::move(other.attributes_)),
      textures_(std::exchange(other.textures_, {})),
      framebuffer_(std::exchange(other.framebuffer_, 0)),
      vertex_array_(std::exchange(other.vertex_array_, 0)),
      bytes_(other.bytes_) {}

LayeredTarget::~LayeredTarget() {
    if (!device_) return;
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    device_->give_back_memory(bytes_);
}

void LayeredTarget::clear() {
    for (size_t i = 0; i < textures_.size(); ++i)
        glClearTexImage(textures_[i], 0, attributes_[i].components == 1 ? GL_RED : GL_RGBA, GL_FLOAT,
                        nullptr);
}

void LayeredTarget::draw(const RasterProgram& program, uint32_t first, uint32_t vertices) {
    const KeptState kept(static_cast<uint32_t>(attributes_.size()));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
    glBindVertexArray(vertex_array_);
    glUseProgram(program.id());
    glViewportIndexedf(0, 0, 0, static_cast<float>(size_.x), static_cast<float>(size_.y));
    for (GLuint i = 0; i < attributes_.size(); ++i) {
        glEnablei(GL_BLEND, i);
        glBlendEquationi(i, attributes_[i].blend == TargetBlend::max ? GL_MAX : GL_FUNC_ADD);
        glBlendFunci(i, GL_ONE, GL_ONE);
    }
    glDrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(vertices));
}

void LayeredTarget::bind_texture(size_t attribute, uint32_t unit) const {
    glBindTextureUnit(unit, textures_[attribute]);
}

}  // namespace lucarne::gi
