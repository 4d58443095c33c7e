#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/device/common/shader_source.h"
#include "gi/device/gl/program.h"
#include "io/core/error.h"

namespace lucarne::gi {

struct DeviceInfo {
    std::string vendor, renderer, version;
    bool software = false;          ///< llvmpipe and the like, whose timer queries return wrong values
    uint64_t max_buffer_bytes = 0;  ///< largest shader storage block that also has texel views
    uint64_t max_texel_bytes = 0;   ///< largest buffer that shaders read only as texels of four words
};

class ClDevice;
class Device;

/// How a shader reads a buffer's words: through `usamplerBuffer`, floats through `samplerBuffer`.
enum class TexelView : uint8_t { one_word, two_words, four_words, four_floats };

/// The memory of a buffer as the host sees it, see Buffer::map(). Move-only; its destructor returns the
/// memory to the device. Until then no command of the device may use the buffer.
class MappedBuffer {
 public:
    MappedBuffer(MappedBuffer&& other) noexcept;
    MappedBuffer& operator=(MappedBuffer&&) = delete;
    ~MappedBuffer();
    template <class T>
    std::span<T> as() const {
        return {reinterpret_cast<T*>(data_), bytes_ / sizeof(T)};
    }

 private:
    friend class Buffer;
    MappedBuffer(uint32_t id, std::byte* data, size_t bytes) : id_(id), data_(data), bytes_(bytes) {}
    uint32_t id_;
    std::byte* data_;
    size_t bytes_;
};

/// A shader storage buffer. Move-only. Its destructor frees its memory and its share of the device's budget,
/// so it must be destroyed before the device.
class Buffer {
 public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer();

    size_t bytes() const { return bytes_; }
    explicit operator bool() const { return id_ != 0; }
    uint32_t id() const { return id_; }
    void bind(uint32_t binding) const;  ///< as shader storage
    /// Binds it as `usamplerBuffer` or `samplerBuffer` to a texture unit, for reading only: llvmpipe fetches
    /// the four words of a texel ten times faster than four words of a storage block (.4 against 4.3 ns).
    void bind_texels(uint32_t unit, TexelView view) const;
    void upload(size_t offset, std::span<const std::byte> data);
    void download(size_t offset, std::span<std::byte> out) const;  ///< waits for the device
    void clear(uint32_t word);                                     ///< sets every 32-bit word
    /// Copies bytes of another buffer on the device.
    void copy_from(const Buffer& from, size_t from_offset, size_t offset, size_t bytes);
    /// Waits for the device and gives the host access to the buffer's own memory. Only for buffers of a
    /// device with native_passes(). Errors: the driver refuses.
    Result<MappedBuffer> map() const;
    template <class T>
    void upload_all(const std::vector<T>& values) {
        upload(0, std::as_bytes(std::span(values)));
    }
    template <class T>
    std::vector<T> download_all(size_t count) const {
        std::vector<T> values(count);
        download(0, std::as_writable_bytes(std::span(values)));
        return values;
    }

 private:
    friend class Device;
    Device* device_ = nullptr;
    uint32_t id_ = 0;
    size_t bytes_ = 0;
    mutable std::array<uint32_t, 4> textures_{};  ///< one a view, made when first bound
};

/// One OpenGL 4.5 core context and everything made in it. Use it from one thread. Whatever a compute program
/// reads or writes is a shader storage buffer, pictures included; raster programs draw into layered targets
/// (layered_target.h).
class Device {
 public:
    /// Creates an EGL surfaceless context: no X server, no window.
    static Result<std::unique_ptr<Device>> headless();
    /// Uses the context that is current on this thread (a GLFW window's). The window must outlive the
    /// device.
    static Result<std::unique_ptr<Device>> current();
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const DeviceInfo& info() const;
    /// Whether passes that are written in C++, too, run there instead of as shaders: where the device is
    /// software and shares the host's memory. LUCARNE_NATIVE=0 turns them off for every device, for
    /// comparisons.
    bool native_passes() const;
    /// Turns native passes off, or on again where the device supports them.
    void use_native_passes(bool use);
    /// Sets how many bytes all buffers, of OpenGL and OpenCL together, may take; an allocation beyond that is
    /// an error.
    void set_memory_cap(uint64_t bytes);
    uint64_t memory_cap() const;
    uint64_t memory_used() const;
    /// Returns whether the cap has refused a buffer since the last call.
    bool take_refusal();

    /// Returns an uninitialised buffer. Errors: over the cap, over max_buffer_bytes, out of device memory.
    Result<Buffer> buffer(size_t bytes, std::string_view what);
    /// The same for buffers that shaders only read as texels of four words: up to max_texel_bytes.
    Result<Buffer> texels(size_t bytes, std::string_view what);
    /// Grows `buffer` to at least `bytes`; growing loses its contents. Errors as for buffer().
    Result<void> reserve(Buffer& buffer, size_t bytes, std::string_view what);

    /// Returns the compute program of an embedded shader ("gi/engines/vpl/shading/shade.comp"), compiled
    /// once for each set of defines. `#include "path"` is resolved among the embedded files. Errors carry
    /// the compiler's first message.
    Result<const Program*> program(std::string_view path, const Defines& defines = {});

    /// The same for a program that rasterizes. `shaders` are a vertex, a geometry and a fragment shader, of
    /// the defines all three.
    Result<const RasterProgram*> raster_program(const RasterShaders& shaders, const Defines& defines = {});

    /// Returns the OpenCL device (gi/device/cl/cl_device.h) that all engines share. The first call starts it,
    /// which takes most of a second; it is destroyed with this device, after everything made on it. Errors:
    /// there is none, or none of the name in LUCARNE_CL_DEVICE.
    Result<ClDevice*> opencl();

    /// Adds a file to the embedded shaders and OpenCL programs, for engines and kernels of tests. A file
    /// added again replaces the earlier one, but not the programs compiled from it.
    void add_shader(std::string path, std::string text);
    /// Compiles shaders and OpenCL programs from the files in `folder`, which stands for the project's root,
    /// for developers of shaders; LUCARNE_SHADERS sets it for every device. If a file does not compile, a
    /// warning and shader_problem() report it and the embedded file is used instead. Passes that run in C++
    /// do not read their shaders: set LUCARNE_NATIVE=0, too.
    void use_shader_folder(const std::filesystem::path& folder);
    /// Reads the folder again and compiles programs whose text has changed. If that fails the last good
    /// program stays. Do not call it while a Program returned by program() is in use; kernels may be kept.
    void reload_shaders();
    /// Returns the first compile error since the folder was last read, with file and line; empty if there is
    /// none.
    const std::string& shader_problem() const;

    /// Waits until all work is done, that of OpenCL too; check() tells whether it failed.
    void finish();
    /// Waits for OpenCL's work only. Does nothing if none was queued.
    void finish_opencl();

    /// Errors: the driver has lost or reset the context, or OpenCL its device. Then everything made
    /// in it is gone, its last results are undefined, and another device has to replace it. Also an error: a
    /// program was given a uniform that its text does not declare, which is a bug of the caller.
    Result<void> check();
    /// For tests: check() fails from its `checks`th call on.
    void lose_after(uint32_t checks);

 private:
    Device();
    /// Counts memory of other things than buffers. Errors: over the cap.
    Result<void> take_memory(uint64_t bytes, std::string_view what);
    void give_back_memory(uint64_t bytes);
    Result<Buffer> make(size_t bytes, uint64_t most, std::string_view what);
    std::unique_ptr<ProgramUniforms> wrapped(const std::vector<std::string>& paths, const std::string& text,
                                             uint32_t id);
    Result<const ProgramUniforms*> compiled(std::vector<std::string> paths, const Defines& defines);
    void note_unknown_uniform(std::string_view path, std::string_view uniform);
    friend class Buffer;
    friend class LayeredTarget;
    friend class ProgramUniforms;
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::gi
