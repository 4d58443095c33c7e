#include "gi/device/cl/cl_device.h"

#include <algorithm>
#include <utility>

#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>
#include <fmt/format.h>

#include "gi/device/gl/shader_source.h"
#include "io/core/log.h"

namespace lucarne::gi {
namespace {

constexpr const char* kInstall = "install the graphics driver's OpenCL, or Debian's pocl-opencl-icd";
constexpr const char* kMemoryTodo = "raise --device-memory, or lower --points";
constexpr const char* kOptions = "-cl-std=CL3.0";

std::string text_of(cl_device_id device, cl_device_info what) {
    size_t bytes = 0;
    if (clGetDeviceInfo(device, what, 0, nullptr, &bytes) != CL_SUCCESS || bytes == 0) return {};
    std::string text(bytes, '\0');
    clGetDeviceInfo(device, what, bytes, text.data(), nullptr);
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    return text;
}

template <class T>
T value_of(cl_device_id device, cl_device_info what) {
    T value{};
    clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
    return value;
}

/// Returns the first device of this kind on any platform; null if there is none.
cl_device_id find_device(cl_device_type kind) {
    cl_uint count = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return nullptr;
    std::vector<cl_platform_id> platforms(count);
    if (count == 0 || clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS) return nullptr;
    for (const cl_platform_id platform : platforms) {
        cl_device_id device = nullptr;
        if (clGetDeviceIDs(platform, kind, 1, &device, nullptr) == CL_SUCCESS) return device;
    }
    return nullptr;
}

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

}  // namespace

Result<void> opencl_available() {
    if (!find_device(CL_DEVICE_TYPE_GPU) && !find_device(CL_DEVICE_TYPE_CPU))
        return failed("OpenCL", "no device was found", kInstall);
    return {};
}

Result<std::unique_ptr<ClDevice>> ClDevice::open(Device& budget) {
    cl_device_id id = find_device(CL_DEVICE_TYPE_GPU);
    const bool is_gpu = id != nullptr;
    if (!id) id = find_device(CL_DEVICE_TYPE_CPU);
    if (!id) return failed("OpenCL", "no device was found", kInstall);
    std::unique_ptr<ClDevice> device(new ClDevice(budget));
    device->id_ = id;
    cl_int problem = CL_SUCCESS;
    device->context_ = clCreateContext(nullptr, 1, &id, keep_message, device.get(), &problem);
    if (problem == CL_SUCCESS)
        device->queue_ = clCreateCommandQueueWithProperties(device->context_, id, nullptr, &problem);
    if (problem != CL_SUCCESS) return tl::make_unexpected(device->device_error("OpenCL", problem));
    const auto platform = value_of<cl_platform_id>(id, CL_DEVICE_PLATFORM);
    char platform_name[256] = {};
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof platform_name - 1, platform_name, nullptr);
    device->info_ = {.name = text_of(id, CL_DEVICE_NAME),
                     .platform = platform_name,
                     .driver = text_of(id, CL_DRIVER_VERSION),
                     .units = value_of<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS),
                     .memory = value_of<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE),
                     .max_buffer_bytes = value_of<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE),
                     .is_gpu = is_gpu};
    return device;
}

ClDevice::~ClDevice() {
    kernels_.clear();
    if (queue_) clReleaseCommandQueue(queue_);
    if (context_) clReleaseContext(context_);
}

Error ClDevice::device_error(std::string_view what, int code) const {
    return {ErrorKind::failed, std::string(what),
            fmt::format("the OpenCL device {} failed with error {}", info_.name, code),
            "see that its driver is up to date"};
}

void ClDevice::keep_message(const char* message, const void*, size_t, void* device) {
    auto* self = static_cast<ClDevice*>(device);
    const std::lock_guard lock(self->message_mutex_);
    if (self->message_.empty()) self->message_ = message && *message ? message : "unknown error";
}

std::string ClDevice::take_message() {
    const std::lock_guard lock(message_mutex_);
    return std::exchange(message_, {});
}

Result<void> ClDevice::usable() const {
    if (lost_) return tl::make_unexpected(*lost_);
    return {};
}

Result<void> ClDevice::answered(std::string_view what, int code) {
    if (calls_left_ && (*calls_left_ == 0 || --*calls_left_ == 0)) code = CL_DEVICE_NOT_AVAILABLE;
    LUCARNE_TRY(check_loss(code));
    if (code != CL_SUCCESS) return tl::make_unexpected(device_error(what, code));
    return {};
}

Result<void> ClDevice::check_loss(int code) {
    const std::string message = take_message();
    if (code == CL_SUCCESS && message.empty()) return {};
    const bool told = code == CL_DEVICE_NOT_AVAILABLE || code == CL_INVALID_DEVICE ||
                      code == CL_INVALID_CONTEXT || code == CL_INVALID_COMMAND_QUEUE;
    // Other codes and messages have harmless causes as well: CL_OUT_OF_RESOURCES may mean a kernel that needs
    // too many registers. If the device is lost its queue fails, too.
    if (!told && clFinish(queue_) == CL_SUCCESS) {
        if (!message.empty()) log::warn("OpenCL: {}", message);
        return {};
    }
    lost_ = Error{ErrorKind::failed, "OpenCL",
                  fmt::format("the device {} was lost (error {}{}{})", info_.name, code,
                              message.empty() ? "" : ": ", message),
                  "see that its driver is up to date"};
    budget_.report_loss(fmt::format("OpenCL: {}", lost_->why));
    return usable();
}

Result<ClBuffer> ClDevice::buffer(size_t bytes, std::string_view what) {
    LUCARNE_TRY(usable());
    bytes = std::max<size_t>(bytes, 16);
    if (bytes > info_.max_buffer_bytes)
        return failed(std::string(what),
                      fmt::format("{} MiB are more than a buffer of {} holds ({} MiB)", bytes >> 20,
                                  info_.name, info_.max_buffer_bytes >> 20),
                      kMemoryTodo);
    LUCARNE_TRY(budget_.take_memory(bytes, what));
    cl_int problem = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, bytes, nullptr, &problem);
    if (problem != CL_SUCCESS) {
        budget_.give_memory_back(bytes);
        LUCARNE_TRY(check_loss(problem));
        return failed(std::string(what),
                      fmt::format("the OpenCL device has no {} MiB of memory left", bytes >> 20),
                      kMemoryTodo);
    }
    ClBuffer made;
    made.device_ = this;
    made.memory_ = memory;
    made.bytes_ = bytes;
    return made;
}

Result<void> ClDevice::reserve(ClBuffer& target, size_t bytes, std::string_view what) {
    if (target && target.bytes() >= bytes) return {};
    target = ClBuffer();  // free the old buffer first, so that both never count together
    LUCARNE_ASSIGN(target, buffer(bytes, what));
    return {};
}

Result<const ClKernel*> ClDevice::kernel(std::string_view path, std::string_view name, const Defines& defines,
                                         const std::vector<ShaderText>& texts) {
    LUCARNE_TRY(usable());
    std::tuple<std::string, std::string, Defines> key(path, name, defines);
    if (const auto found = kernels_.find(key); found != kernels_.end()) return found->second.get();
    const std::string what = fmt::format("kernel {} of {}", name, path);
    LUCARNE_ASSIGN(const ShaderSource source, shader_source(path, defines, texts, ShaderLanguage::opencl));
    const char* text = source.text.c_str();
    cl_int problem = CL_SUCCESS;
    const cl_program program = clCreateProgramWithSource(context_, 1, &text, nullptr, &problem);
    LUCARNE_TRY(check_loss(problem));
    if (problem != CL_SUCCESS) return tl::make_unexpected(device_error(what, problem));
    problem = clBuildProgram(program, 1, &id_, kOptions, nullptr, nullptr);
    if (problem != CL_SUCCESS) {
        size_t bytes = 0;
        clGetProgramBuildInfo(program, id_, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
        std::string log(bytes, '\0');
        clGetProgramBuildInfo(program, id_, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
        clReleaseProgram(program);
        LUCARNE_TRY(check_loss(problem));
        return failed(what, first_error(log), "it is a fault of the program or of the driver");
    }
    const cl_kernel made = clCreateKernel(program, std::string(name).c_str(), &problem);
    if (problem != CL_SUCCESS) {
        clReleaseProgram(program);
        LUCARNE_TRY(check_loss(problem));
        return failed(what, "there is no such function", "it is a fault of the program");
    }
    std::unique_ptr<ClKernel> kernel(new ClKernel(*this, program, made, what));
    return kernels_.emplace(std::move(key), std::move(kernel)).first->second.get();
}

Result<void> ClDevice::finish() {
    LUCARNE_TRY(usable());
    return answered("OpenCL", clFinish(queue_));
}

ClBuffer& ClBuffer::operator=(ClBuffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

ClBuffer::~ClBuffer() {
    if (!memory_) return;
    clReleaseMemObject(memory_);
    device_->budget_.give_memory_back(bytes_);
}

Result<void> ClBuffer::upload(size_t offset, std::span<const std::byte> data) {
    if (offset > bytes_ || data.size() > bytes_ - offset)
        return failed("OpenCL", "an upload is larger than its buffer");
    if (data.empty()) return {};
    LUCARNE_TRY(device_->usable());
    return device_->answered("upload", clEnqueueWriteBuffer(device_->queue_, memory_, CL_TRUE, offset,
                                                            data.size(), data.data(), 0, nullptr, nullptr));
}

Result<void> ClBuffer::download(size_t offset, std::span<std::byte> out) const {
    if (offset > bytes_ || out.size() > bytes_ - offset)
        return failed("OpenCL", "a download is larger than its buffer");
    if (out.empty()) return {};
    LUCARNE_TRY(device_->usable());
    return device_->answered("download", clEnqueueReadBuffer(device_->queue_, memory_, CL_TRUE, offset,
                                                             out.size(), out.data(), 0, nullptr, nullptr));
}

ClKernel::~ClKernel() {
    clReleaseKernel(kernel_);
    clReleaseProgram(program_);
}

Result<void> ClKernel::set(uint32_t index, const ClBuffer& buffer) const {
    return set_bytes(index, &buffer.memory_, sizeof buffer.memory_);
}

Result<void> ClKernel::set_bytes(uint32_t index, const void* value, size_t bytes) const {
    if (clSetKernelArg(kernel_, index, bytes, value) == CL_SUCCESS) return {};
    return failed(name_, fmt::format("argument {} does not fit", index), "it is a fault of the program");
}

Result<void> ClKernel::enqueue(size_t items, size_t group) const {
    if (items == 0) return {};
    if (group > 0) items = (items + group - 1) / group * group;
    LUCARNE_TRY(device_->usable());
    return device_->answered(name_, clEnqueueNDRangeKernel(device_->queue_, kernel_, 1, nullptr, &items,
                                                           group ? &group : nullptr, 0, nullptr, nullptr));
}

}  // namespace lucarne::gi
