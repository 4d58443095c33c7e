#pragma once

#include "gi/device/cl/cl_device.h"
#include "gi/device/gl/device.h"

// Buffers from OpenGL to OpenCL and back, through the host's memory: neither PoCL nor headless NVIDIA shares
// them.
namespace lucarne::gi {

/// The first `bytes` of `from`; `to` grows as needed. Waits for both devices. Errors: memory, or a device
/// failed.
Result<void> copy_to_cl(const Buffer& from, size_t bytes, ClDevice& device, ClBuffer& to,
                        std::string_view what);
Result<void> copy_to_gl(const ClBuffer& from, size_t bytes, Device& device, Buffer& to,
                        std::string_view what);

}  // namespace lucarne::gi
