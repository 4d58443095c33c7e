#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "gi/device/cl/cl_buffer.h"
#include "gi/device/cl/cl_context.h"
#include "gi/device/cl/cl_kernel.h"
#include "gi/device/cl/cl_program.h"
#include "gi/device/common/shader_files.h"
#include "gi/device/common/shader_source.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// What an OpenCL device takes from the OpenGL device that owns it.
struct ClHost {
    MemoryBudget& memory;  ///< its cap holds for both devices
    ShaderFiles& shaders;
    ClContext::ReportLoss report_loss;
};

/// The OpenCL device of all engines, with one in-order queue. Device::opencl() makes it and owns it. Use it
/// from the OpenGL device's thread. Engines ask for it in Engine::prepare, because starting OpenCL takes most
/// of a second.
///
/// If its driver is reset or the device removed, all calls return errors from then on and Device::check()
/// of the OpenGL device does so as well: both devices and everything made on them have to be replaced.
class ClDevice {
 public:
    /// Opens the device of choose_cl_device(). What `host` refers to must outlive it. Errors: no device.
    static Result<std::unique_ptr<ClDevice>> open(ClHost host);

    const ClDeviceInfo& info() const { return context_->info(); }
    /// Returns an uninitialised buffer. Errors: over the cap, over max_buffer_bytes, out of device memory.
    Result<ClBuffer> buffer(size_t bytes, std::string_view what);
    /// Grows `buffer` to at least `bytes`; growing loses its contents. Errors as for buffer().
    Result<void> reserve(ClBuffer& buffer, size_t bytes, std::string_view what);
    /// Makes `buffer` hold `data`, which kernels only read. A processor reads it where it is, so `owner`
    /// keeps it as long as the buffer is in use, and it must not change; any other device gets a copy. Empty
    /// data is an error, as are those of buffer().
    Result<void> lend(ClBuffer& buffer, std::span<const std::byte> data, std::shared_ptr<const void> owner,
                      std::string_view what);
    /// Returns the function `name` of an embedded source ("gi/engines/micro/gather.cl"). A source is compiled
    /// once for each set of defines, whatever the number of its kernels. The pointer is valid as long as the
    /// device. Includes are resolved as in shaders, and files are read from Device::use_shader_folder() as
    /// shaders are. The driver caches the binaries (PoCL in POCL_CACHE_DIR). Errors carry the compiler's
    /// first message with file and line.
    Result<const ClKernel*> kernel(std::string_view path, std::string_view name, const Defines& defines = {});
    /// Compiles programs again whose text has changed. If that fails the last good program stays and
    /// Device::shader_problem() tells why. Device::reload_shaders() calls it.
    void reload_programs();
    /// Returns how often a program was compiled with success.
    uint32_t programs_built() const { return programs_built_; }

    /// Whether work was queued for which nobody has waited.
    bool is_busy() const { return context_->is_busy(); }
    /// Waits until all queued work is done. Errors: the device failed.
    Result<void> finish() { return context_->finish(); }
    /// For tests: the driver answers the `calls`th upload, download, run or wait from now on as that of a
    /// removed device does.
    void lose_after(uint32_t calls) { context_->lose_after(calls); }

 private:
    using Key = std::tuple<std::string, Defines>;

    ClDevice(ShaderFiles& shaders, std::unique_ptr<ClContext> context)
        : shaders_(shaders), context_(std::move(context)) {}
    /// Compiles `program` from `texts`.
    Result<void> build(ClProgram& program, const Key& key, const std::vector<ShaderText>& texts);
    Result<ClProgram*> program(const Key& key);

    ShaderFiles& shaders_;
    std::unique_ptr<ClContext> context_;
    std::map<Key, std::unique_ptr<ClProgram>> programs_;
    uint32_t programs_built_ = 0;
};

}  // namespace lucarne::gi
