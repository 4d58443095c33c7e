#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"

namespace lucarne::gi {

/// How what is drawn joins what a cell of a target holds.
enum class TargetBlend : uint8_t { add, max };

/// One of the values that each cell of a layered target holds: an output of the fragment shader.
struct TargetAttribute {
    uint32_t components = 4;  ///< 1 or 4
    uint32_t bits = 32;       ///< of a component, a float: 16 or 32
    TargetBlend blend = TargetBlend::add;

    uint64_t bytes() const { return uint64_t{components} * bits / 8; }
};

/// A 3D picture of several attributes that raster programs draw into: the geometry shader chooses the layer.
/// It has no depth buffer, and no triangle is culled (the Volume Buffer of Gaitatzes 2012, chapter 6).
/// Move-only. It counts as memory of its device, and must be destroyed before it.
class LayeredTarget {
 public:
    /// At most so many attributes of four 32-bit floats: 1024 bits a cell.
    static constexpr size_t kMostAttributes = 8;

    /// `size`: width, height and layers. Returns a target of undefined content. Errors: over the device's
    /// limits or its memory cap, no layered drawing of these formats.
    static Result<LayeredTarget> create(Device& device, const glm::ivec3& size,
                                        std::span<const TargetAttribute> attributes, std::string_view what);
    LayeredTarget(LayeredTarget&& other) noexcept;
    LayeredTarget& operator=(LayeredTarget&&) = delete;
    ~LayeredTarget();

    const glm::ivec3& size() const { return size_; }
    /// Sets all attributes to zero.
    void clear();
    /// Draws triangles: the vertex shader runs `vertices` times, with gl_VertexID from `first` on. The state
    /// of the context is afterwards as it was before.
    void draw(const RasterProgram& program, uint32_t first, uint32_t vertices);
    /// Binds an attribute as `sampler3D` to a texture unit.
    void bind_texture(size_t attribute, uint32_t unit) const;

 private:
    LayeredTarget() = default;

    Device* device_ = nullptr;
    glm::ivec3 size_{0};
    std::vector<TargetAttribute> attributes_;
    std::vector<uint32_t> textures_;
    uint32_t framebuffer_ = 0, vertex_array_ = 0;
    uint64_t bytes_ = 0;
};

}  // namespace lucarne::gi
