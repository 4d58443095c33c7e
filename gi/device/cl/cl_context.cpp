#include "gi/device/cl/cl_context.h"

#include <utility>

#include <fmt/format.h>

#include "gi/device/cl/cl_api.h"
#include "gi/device/cl/cl_choice.h"
#include "io/core/log.h"

namespace lucarne::gi {
namespace {

template <class T>
T cl_value(cl_device_id device, cl_device_info what) {
    T value{};
    clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
    return value;
}

ClDeviceInfo info_of(cl_device_id id) {
    const auto platform = cl_value<cl_platform_id>(id, CL_DEVICE_PLATFORM);
    char platform_name[256] = {};
    clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof platform_name - 1, platform_name, nullptr);
    return {.name = cl_text(id, CL_DEVICE_NAME),
            .platform = platform_name,
            .driver = cl_text(id, CL_DRIVER_VERSION),
            .units = cl_value<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS),
            .memory = cl_value<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE),
            .max_buffer_bytes = cl_value<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE),
            .local_memory = cl_value<cl_ulong>(id, CL_DEVICE_LOCAL_MEM_SIZE),
            .max_group_size = cl_value<size_t>(id, CL_DEVICE_MAX_WORK_GROUP_SIZE),
            .is_gpu = (cl_value<cl_device_type>(id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) != 0};
}

}  // namespace

Result<std::unique_ptr<ClContext>> ClContext::open(MemoryBudget& memory, ReportLoss report_loss) {
    LUCARNE_ASSIGN(const cl_device_id id, choose_cl_device());
    std::unique_ptr<ClContext> made(new ClContext(memory, std::move(report_loss)));
    made->id_ = id;
    made->info_ = info_of(id);
    cl_int problem = CL_SUCCESS;
    made->context_ = clCreateContext(nullptr, 1, &id, keep_message, made.get(), &problem);
    if (problem == CL_SUCCESS)
        made->queue_ = clCreateCommandQueueWithProperties(made->context_, id, nullptr, &problem);
    if (problem != CL_SUCCESS) return tl::make_unexpected(made->device_error("OpenCL", problem));
    return made;
}

ClContext::~ClContext() {
    if (queue_ && !lost_) clFinish(queue_);  // no message comes after this
    if (queue_) clReleaseCommandQueue(queue_);
    if (context_) clReleaseContext(context_);
}

Error ClContext::device_error(std::string_view what, int code) const {
    return {ErrorKind::failed, std::string(what),
            fmt::format("the OpenCL device {} failed with error {}", info_.name, code),
            "see that its driver is up to date"};
}

void ClContext::keep_message(const char* message, const void*, size_t, void* context) {
    auto* self = static_cast<ClContext*>(context);
    const std::lock_guard lock(self->message_mutex_);
    if (self->message_.empty()) self->message_ = message && *message ? message : "unknown error";
}

std::string ClContext::take_message() {
    const std::lock_guard lock(message_mutex_);
    return std::exchange(message_, {});
}

Result<void> ClContext::usable() const {
    if (lost_) return tl::make_unexpected(*lost_);
    return {};
}

Result<void> ClContext::answered(std::string_view what, int code) {
    if (calls_left_ && (*calls_left_ == 0 || --*calls_left_ == 0)) code = CL_DEVICE_NOT_AVAILABLE;
    LUCARNE_TRY(check_loss(code));
    if (code != CL_SUCCESS) return tl::make_unexpected(device_error(what, code));
    return {};
}

Result<void> ClContext::check_loss(int code) {
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
    report_loss_(fmt::format("OpenCL: {}", lost_->why));
    return usable();
}

Result<void> ClContext::finish() {
    LUCARNE_TRY(usable());
    busy_ = false;
    return answered("OpenCL", clFinish(queue_));
}

}  // namespace lucarne::gi
