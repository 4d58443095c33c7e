#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/core/error.h"

namespace lucarne::gi {

struct DeviceInfo {
    std::string vendor, renderer, version;
    bool software = false;          ///< llvmpipe and the like: timer queries are nonsense there
    bool atomic_int64 = false;      ///< GL_NV_shader_atomic_int64
    uint64_t max_buffer_bytes = 0;  ///< of one shader storage block and its texel views
    uint64_t max_texel_bytes = 0;   ///< of a buffer that shaders read as texels of four words alone
};

class Device;

/// How a buffer's words look to `usamplerBuffer`, or to `samplerBuffer` for floats.
enum class TexelView : uint8_t { one_word, two_words, four_words, four_floats };

/// A shader storage buffer. Move-only; frees its memory and its share of the device's budget, and so must go
/// before the device does.
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
    /// As `usamplerBuffer` or `samplerBuffer` at a texture unit, for reading only: llvmpipe fetches four
    /// words of a texel ten times faster than four words of a storage block (.4 against 4.3 ns).
    void bind_texels(uint32_t unit, TexelView view) const;
    void upload(size_t offset, std::span<const std::byte> data);
    void download(size_t offset, std::span<std::byte> out) const;  ///< waits for the device
    void clear(uint32_t word);                                     ///< every 32-bit word
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
    mutable std::array<uint32_t, 4> textures_{};  ///< made when first bound, one a view
};

/// The names of the uniforms that a shader's text declares, whether or not they are used.
std::set<std::string, std::less<>> declared_uniforms(std::string_view text);

/// A compiled compute program; owned by the device's cache.
class Program {
 public:
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;
    void set(std::string_view uniform, int32_t value) const;
    void set(std::string_view uniform, uint32_t value) const;
    void set(std::string_view uniform, float value) const;
    void set_block(std::string_view uniform,
                   std::span<const float> values) const;  ///< float or vec arrays: flat
    /// Enough groups of the program's local size for x * y * z invocations, then a barrier for all reads.
    void dispatch(uint32_t x, uint32_t y = 1, uint32_t z = 1) const;
    /// The numbers of groups are three words of `groups` at `offset` bytes, written by the device.
    void dispatch_indirect(const Buffer& groups, size_t offset = 0) const;

 private:
    friend class Device;
    struct Uniform {
        int32_t location;
        uint32_t type;
    };
    /// `text`: what it was compiled from.
    Program(Device& device, std::string_view path, std::string_view text, uint32_t id);
    /// Null for uniforms that the compiler found unused: setting those is no error. Setting one that the text
    /// does not declare is: Device::check() says so.
    const Uniform* find(std::string_view uniform) const;

    Device* device_;
    std::string path_;
    uint32_t id_;
    std::set<std::string, std::less<>> declared_;
    uint32_t local_[3] = {1, 1, 1};
    std::map<std::string, Uniform, std::less<>> uniforms_;
};

using Defines = std::vector<std::pair<std::string, std::string>>;

/// One OpenGL 4.5 core context and all that is made in it; used from one thread. Everything a program reads
/// or writes is a shader storage buffer; pictures included.
class Device {
 public:
    /// An EGL surfaceless context: no X server, no window.
    static Result<std::unique_ptr<Device>> headless();
    /// Takes the context that is current on this thread (a GLFW window's); the window outlives the device.
    static Result<std::unique_ptr<Device>> current();
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const DeviceInfo& info() const;
    /// Bytes that buffers may take in all; an allocation beyond it is an error.
    void set_memory_cap(uint64_t bytes);
    uint64_t memory_cap() const;
    uint64_t memory_used() const;
    /// Whether the cap refused a buffer since this was last asked.
    bool take_refusal();

    /// Counts memory that another device takes, under the same cap. Errors: over the cap.
    Result<void> take_memory(uint64_t bytes, std::string_view what);
    void give_memory_back(uint64_t bytes);

    /// Not initialised. Errors: over the cap, over max_buffer_bytes, out of device memory.
    Result<Buffer> buffer(size_t bytes, std::string_view what);
    /// The same for what shaders only read as texels of four words; up to max_texel_bytes.
    Result<Buffer> texels(size_t bytes, std::string_view what);
    /// Makes `buffer` hold at least `bytes`; contents are lost when it grows.
    Result<void> reserve(Buffer& buffer, size_t bytes, std::string_view what);

    /// The compute program of an embedded shader ("gi/engines/vpl/shading/shade.comp"), compiled once for
    /// each set of defines.
    /// `#include "path"` is resolved among the embedded files. Errors carry the compiler's first message.
    Result<const Program*> program(std::string_view path, const Defines& defines = {});

    /// Programs are made of the files in a folder that stands for the project's root, for who writes shaders;
    /// LUCARNE_SHADERS names it for every device. A file that does not compile is reported by a warning and
    /// shader_problem(); the program's own is used instead.
    void use_shader_folder(const std::filesystem::path& folder);
    /// Reads the folder again. Programs whose text has changed are compiled anew; where that fails the last
    /// good one stays. Not while one that program() gave is in use.
    void reload_shaders();
    /// The first compile error since the folder was last read, with file and line; empty: there is none.
    const std::string& shader_problem() const;

    void finish();  ///< waits until all work is done

    /// Errors: the driver has lost or reset the context; all that was made in it is gone, and what it was
    /// last asked for is nonsense. Another device has to take its place. Or a program was given a uniform
    /// that its text does not declare: a mistake of whoever called it.
    Result<void> check();
    /// For tests: check() fails from its `checks`th call on.
    void lose_after(uint32_t checks);

 private:
    Device();
    Result<Buffer> make(size_t bytes, uint64_t most, std::string_view what);
    void note_shader_problem(const Error& error);
    void note_unknown_uniform(std::string_view path, std::string_view uniform);
    friend class Buffer;
    friend class Program;
    struct State;
    std::unique_ptr<State> state_;
};

/// Times passes of a frame: wall clock with `finish` around each pass (exact on software devices; on a GPU it
/// costs a little overlap and is exact as well).
class PassTimes {
 public:
    explicit PassTimes(Device& device) : device_(device) {}
    void begin(std::string name);
    void end();
    struct Pass {
        std::string name;
        double seconds;
    };
    const std::vector<Pass>& passes() const { return passes_; }
    void clear() { passes_.clear(); }

 private:
    Device& device_;
    std::string name_;
    double start_ = 0;
    std::vector<Pass> passes_;
};

}  // namespace lucarne::gi
