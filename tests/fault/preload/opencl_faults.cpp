// A part of the library for LD_PRELOAD: calls of OpenCL that fail. LUCARNE_CL_FAULT selects one:
//
//   build      no program can be built
//   buffer:N   from the N-th buffer on (from 1), the device has no memory left
//   kernel:N   from the N-th run of a kernel on, the device is lost
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <dlfcn.h>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace {

/// Whether a call of this kind fails; `calls`: how many of its kind there have been.
bool fails(const std::string& kind, std::atomic<int64_t>& calls) {
    const char* set = std::getenv("LUCARNE_CL_FAULT");
    const std::string fault = set ? set : "";
    if (fault.compare(0, kind.size(), kind) != 0) return false;
    const size_t number = fault.find(':');
    return ++calls >= (number == std::string::npos ? 1 : std::atoll(fault.c_str() + number + 1));
}

template <class Function>
Function* next_of(Function*, const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void(CL_CALLBACK* done)(cl_program, void*), void* data) {
    static std::atomic<int64_t> calls;
    if (fails("build", calls)) return CL_BUILD_PROGRAM_FAILURE;
    return next_of(&clBuildProgram, "clBuildProgram")(program, count, devices, options, done, data);
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* host, cl_int* problem) {
    static std::atomic<int64_t> calls;
    if (!fails("buffer", calls))
        return next_of(&clCreateBuffer, "clCreateBuffer")(context, flags, bytes, host, problem);
    if (problem) *problem = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    return nullptr;
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* global, const size_t* local, cl_uint count,
                              const cl_event* waits, cl_event* event) {
    static std::atomic<int64_t> calls;
    if (fails("kernel", calls)) return CL_OUT_OF_RESOURCES;
    return next_of(&clEnqueueNDRangeKernel, "clEnqueueNDRangeKernel")(queue, kernel, dimensions, offset,
                                                                      global, local, count, waits, event);
}

}  // extern "C"
