#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "gi/device/cl/cl_context.h"
#include "io/core/error.h"

struct _cl_mem;

namespace lucarne::gi {

/// A buffer in the memory of an OpenCL device. It counts against the memory cap of the OpenGL device, and
/// must be destroyed before it. Move-only.
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
    /// See ClDevice::buffer() and ClDevice::lend().
    static Result<ClBuffer> make(ClContext& context, size_t bytes, std::string_view what);
    static Result<ClBuffer> lend(ClContext& context, std::span<const std::byte> data,
                                 std::shared_ptr<const void> owner, std::string_view what);
    /// `lent`: the host's memory that the device reads; null: memory of the device.
    static Result<ClBuffer> create(ClContext& context, size_t bytes, const std::byte* lent,
                                   std::string_view what);

    ClContext* context_ = nullptr;
    _cl_mem* memory_ = nullptr;
    size_t bytes_ = 0;
    std::shared_ptr<const void> owner_;  ///< of what is lent
};

}  // namespace lucarne::gi
