#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace lucarne::gi {

class Buffer;
class Device;

/// Returns the names of the uniforms that a shader's text declares, used or not.
std::set<std::string, std::less<>> declared_uniforms(std::string_view text);

/// A compiled program and its uniforms by name. The cache of its Device owns it.
class ProgramUniforms {
 public:
    virtual ~ProgramUniforms();
    ProgramUniforms(const ProgramUniforms&) = delete;
    ProgramUniforms& operator=(const ProgramUniforms&) = delete;
    void set(std::string_view uniform, int32_t value) const;
    void set(std::string_view uniform, uint32_t value) const;
    void set(std::string_view uniform, float value) const;
    void set_block(std::string_view uniform,
                   std::span<const float> values) const;  ///< arrays of float or vec, flattened

 protected:
    struct Uniform {
        int32_t location;
        uint32_t type;
    };
    /// `text` is the source that it was compiled from.
    ProgramUniforms(Device& device, std::string_view path, std::string_view text, uint32_t id);
    /// Returns null for uniforms that the compiler removed as unused; setting those is no error. Setting a
    /// uniform that the text does not declare is an error, which Device::check() reports.
    const Uniform* find(std::string_view uniform) const;
    uint32_t id() const { return id_; }

 private:
    Device* device_;
    std::string path_;
    uint32_t id_;
    std::set<std::string, std::less<>> declared_;
    std::map<std::string, Uniform, std::less<>> uniforms_;
};

/// A compute program.
class Program final : public ProgramUniforms {
 public:
    /// Dispatches enough workgroups for x * y * z invocations, then issues a barrier for all kinds of reads.
    void dispatch(uint32_t x, uint32_t y = 1, uint32_t z = 1) const;
    /// Dispatches as many groups as the three words at `offset` bytes of `groups` say, which the device
    /// wrote.
    void dispatch_indirect(const Buffer& groups, size_t offset = 0) const;

 private:
    friend class Device;
    Program(Device& device, std::string_view path, std::string_view text, uint32_t id);

    uint32_t local_[3] = {1, 1, 1};
};

/// Paths of the shaders of a program that rasterizes.
struct RasterShaders {
    std::string_view vertex, geometry, fragment;
};

/// A program of a vertex, a geometry and a fragment shader. LayeredTarget::draw() runs it.
class RasterProgram final : public ProgramUniforms {
 private:
    friend class Device;
    friend class LayeredTarget;
    RasterProgram(Device& device, std::string_view path, std::string_view text, uint32_t id)
        : ProgramUniforms(device, path, text, id) {}
};

}  // namespace lucarne::gi
