#pragma once

// OpenCL's own header, for the .cpp files of this folder. Its handles are declared forward elsewhere.
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>
