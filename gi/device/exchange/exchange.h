#pragma once

#include "gi/device/cl/cl_device.h"
#include "gi/device/gl/device.h"

// Copies buffers between OpenGL and OpenCL through host memory, because neither PoCL nor headless NVIDIA
// shares them.
namespace lucarne::gi {

/// Copy the first `bytes` of `from`; `to` grows as needed. Both wait for both devices. Errors: no memory, a
/// device failed.
Result<void> copy_to_cl(const Buffer& from, size_t bytes, ClDevice& device, ClBuffer& to,
                        std::string_view what);
Result<void> copy_to_gl(const ClBuffer& from, size_t bytes, Device& device, Buffer& to,
                        std::string_view what);

}  // namespace lucarne::gi
