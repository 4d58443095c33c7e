#include "gi/device/cl/cl_program.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/device/cl/cl_api.h"

namespace lucarne::gi {
namespace {

constexpr const char* kOptions = "-cl-std=CL3.0";

struct ReleaseProgram {
    void operator()(cl_program program) const { clReleaseProgram(program); }
};
struct ReleaseKernel {
    void operator()(cl_kernel kernel) const { clReleaseKernel(kernel); }
};

/// Returns the first error of clang's log, which names file and line itself.
std::string first_error(const std::string& log) {
    for (size_t at = 0; at < log.size();) {
        const size_t end = std::min(log.find('\n', at), log.size());
        const std::string line = log.substr(at, end - at);
        if (line.find("error") != line.npos) return line;
        at = end + 1;
    }
    return log.empty() ? "the compiler gave no reason" : log.substr(0, log.find('\n'));
}

std::string build_log(cl_program program, cl_device_id device) {
    size_t bytes = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
    std::string log(bytes, '\0');
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
    return log;
}

}  // namespace

ClProgram::~ClProgram() {
    kernels_.clear();
    if (program_) clReleaseProgram(program_);
}

std::string ClProgram::name_of(std::string_view kernel) const {
    return fmt::format("kernel {} of {}", kernel, path_);
}

Result<void> ClProgram::compile(std::string text) {
    LUCARNE_TRY(context_.usable());
    const std::string what = fmt::format("program {}", path_);
    const char* source = text.c_str();
    const cl_device_id device = context_.id();
    cl_int problem = CL_SUCCESS;
    std::unique_ptr<_cl_program, ReleaseProgram> made(
        clCreateProgramWithSource(context_.context(), 1, &source, nullptr, &problem));
    LUCARNE_TRY(context_.check_loss(problem));
    if (problem != CL_SUCCESS) return tl::make_unexpected(context_.device_error(what, problem));
    problem = clBuildProgram(made.get(), 1, &device, kOptions, nullptr, nullptr);
    if (problem != CL_SUCCESS) {
        const std::string log = build_log(made.get(), device);
        LUCARNE_TRY(context_.check_loss(problem));
        return failed(what, first_error(log), "it is a fault of the program or of the driver");
    }
    std::vector<std::unique_ptr<_cl_kernel, ReleaseKernel>> remade;
    for (const auto& [name, kernel] : kernels_) {
        LUCARNE_ASSIGN(const cl_kernel again, make_kernel(made.get(), name));
        remade.emplace_back(again);
    }
    for (size_t i = 0; const auto& [name, kernel] : kernels_) kernel->adopt(remade[i++].release());
    if (program_) clReleaseProgram(program_);
    program_ = made.release();
    text_ = std::move(text);
    return {};
}

Result<_cl_kernel*> ClProgram::make_kernel(_cl_program* program, const std::string& name) const {
    cl_int problem = CL_SUCCESS;
    const cl_kernel made = clCreateKernel(program, name.c_str(), &problem);
    if (problem == CL_SUCCESS) return made;
    LUCARNE_TRY(context_.check_loss(problem));
    return failed(name_of(name), "there is no such function", "it is a fault of the program");
}

Result<const ClKernel*> ClProgram::kernel(std::string_view name) {
    if (const auto found = kernels_.find(name); found != kernels_.end()) return found->second.get();
    LUCARNE_ASSIGN(const cl_kernel made, make_kernel(program_, std::string(name)));
    std::unique_ptr<ClKernel> kernel(new ClKernel(context_, name_of(name)));
    kernel->adopt(made);
    return kernels_.emplace(name, std::move(kernel)).first->second.get();
}

}  // namespace lucarne::gi
