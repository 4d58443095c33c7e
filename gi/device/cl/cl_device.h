#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/device/gl/shader_texts.h"
#include "io/core/error.h"

// Forward declarations of OpenCL's handles, which keep its headers inside cl_device.cpp.
struct _cl_context;
struct _cl_command_queue;
struct _cl_device_id;
struct _cl_kernel;
struct _cl_mem;
struct _cl_program;

namespace lucarne::gi {

class ClDevice;

/// Returns whether there is an OpenCL device. Errors: there is none, and which package brings one.
Result<void> opencl_available();

/// A buffer in the memory of an OpenCL device. It counts against the memory cap of the OpenGL device.
/// Move-only.
class ClBuffer {
 public:
    ClBuffer() = default;
    ClBuffer(ClBuffer&& other) noexcept { *this = std::move(other); }
    ClBuffer& operator=(ClBuffer&& other) noexcept;
    ~ClBuffer();

    size_t bytes() const { return bytes_; }
    explicit operator bool() const { return memory_ != nullptr; }
    /// Copy to and from the host; both wait for the device. Errors: out of bounds, the device failed.
    Result<void> upload(size_t offset, std::span<const std::byte> data);
    Result<void> download(size_t offset, std::span<std::byte> out) const;

 private:
    friend class ClDevice;
    friend class ClKernel;
    ClDevice* device_ = nullptr;
    _cl_mem* memory_ = nullptr;
    size_t bytes_ = 0;
};

/// A kernel function of a compiled OpenCL program. The cache of its ClDevice owns it.
class ClKernel {
 public:
    ~ClKernel();
    ClKernel(const ClKernel&) = delete;
    ClKernel& operator=(const ClKernel&) = delete;
    /// Sets the arguments in order and runs `items` work-items in groups of `group` (0: the driver chooses).
    /// `items` is rounded up to whole groups. Arguments are ClBuffers and plain values (uint32_t, float).
    /// Errors: an argument does not fit, the device failed.
    template <class... Arguments>
    Result<void> run(size_t items, size_t group, const Arguments&... arguments) const {
        uint32_t index = 0;
        Result<void> done;
        ((done = done ? set(index++, arguments) : done), ...);
        return done ? enqueue(items, group) : done;
    }

 private:
    friend class ClDevice;
    ClKernel(ClDevice& device, _cl_program* program, _cl_kernel* kernel, std::string name)
        : device_(&device), program_(program), kernel_(kernel), name_(std::move(name)) {}
    Result<void> set(uint32_t index, const ClBuffer& buffer) const;
    Result<void> set(uint32_t index, uint32_t value) const { return set_bytes(index, &value, sizeof value); }
    Result<void> set(uint32_t index, float value) const { return set_bytes(index, &value, sizeof value); }
    Result<void> set_bytes(uint32_t index, const void* value, size_t bytes) const;
    Result<void> enqueue(size_t items, size_t group) const;

    ClDevice* device_;
    _cl_program* program_;
    _cl_kernel* kernel_;
    std::string name_;
};

struct ClDeviceInfo {
    std::string name, platform, driver;
    uint32_t units = 0;
    uint64_t memory = 0, max_buffer_bytes = 0;
    bool is_gpu = false;
};

/// One OpenCL device with one in-order queue. Use it from the OpenGL device's thread. Engines that need it
/// open it in Engine::prepare, because starting OpenCL takes most of a second.
///
/// If its driver is reset or the device removed, all calls return errors from then on and Device::check()
/// of the OpenGL device does so as well: both devices and everything made on them have to be replaced.
class ClDevice {
 public:
    /// Opens the first GPU of any platform, else the first processor. The memory cap of `budget` holds for
    /// both devices; `budget` must outlive this. Errors: no device; the message says what to install.
    static Result<std::unique_ptr<ClDevice>> open(Device& budget);
    ~ClDevice();
    ClDevice(const ClDevice&) = delete;
    ClDevice& operator=(const ClDevice&) = delete;

    const ClDeviceInfo& info() const { return info_; }
    /// Returns an uninitialised buffer. Errors: over the cap, over max_buffer_bytes, out of device memory.
    Result<ClBuffer> buffer(size_t bytes, std::string_view what);
    /// Grows `buffer` to at least `bytes`; growing loses its contents. Errors as for buffer().
    Result<void> reserve(ClBuffer& buffer, size_t bytes, std::string_view what);
    /// Returns the function `name` of an embedded source ("gi/engines/micro/gather.cl"), compiled once for
    /// each set of defines. Includes are resolved as in shaders. The driver caches the binaries (PoCL in
    /// POCL_CACHE_DIR). Errors carry the compiler's first message with file and line.
    Result<const ClKernel*> kernel(std::string_view path, std::string_view name, const Defines& defines = {},
                                   const std::vector<ShaderText>& texts = shader_texts());
    /// Waits until all queued work is done. Errors: the device failed.
    Result<void> finish();
    /// For tests: the driver answers the `calls`th upload, download, run or finish() from now on as that of a
    /// removed device does.
    void lose_after(uint32_t calls) { calls_left_ = calls; }

 private:
    friend class ClBuffer;
    friend class ClKernel;
    explicit ClDevice(Device& budget) : budget_(budget) {}
    /// The context's error callback; drivers call it on any thread.
    static void keep_message(const char* message, const void*, size_t, void* device);
    std::string take_message();
    Error device_error(std::string_view what, int code) const;
    /// Errors: the device was lost earlier. Call it before the driver.
    Result<void> usable() const;
    /// Turns the driver's answer to an upload, download, run or wait into a result.
    Result<void> answered(std::string_view what, int code);
    /// Errors: the answer, or a message of the driver, comes from a lost device. Reports that to the OpenGL
    /// device as well.
    Result<void> check_loss(int code);

    Device& budget_;
    ClDeviceInfo info_;
    _cl_device_id* id_ = nullptr;
    _cl_context* context_ = nullptr;
    _cl_command_queue* queue_ = nullptr;
    std::optional<Error> lost_;
    std::optional<uint32_t> calls_left_;  ///< see lose_after()
    std::mutex message_mutex_;
    std::string message_;  ///< the driver's first since take_message()
    std::map<std::tuple<std::string, std::string, Defines>, std::unique_ptr<ClKernel>> kernels_;
};

}  // namespace lucarne::gi
