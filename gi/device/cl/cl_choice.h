#pragma once

#include <cstdint>
#include <string>

#include "io/core/error.h"

struct _cl_device_id;

namespace lucarne::gi {

/// Returns whether there is an OpenCL device that choose_cl_device() takes. Errors as there.
Result<void> opencl_available();

/// Returns the first device whose name contains LUCARNE_CL_DEVICE, in upper or lower case; GPUs come first,
/// then processors. Where the variable is not set or empty it is the first GPU of any platform, else the
/// first processor. Errors: no device, and which package brings one; none of this name, and which there are.
Result<_cl_device_id*> choose_cl_device();

/// Returns a text that a device has (CL_DEVICE_NAME), without spaces at its end; empty on error.
std::string cl_text(_cl_device_id* device, uint32_t what);

}  // namespace lucarne::gi
