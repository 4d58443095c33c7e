#include "gi/device/cl/cl_buffer.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "gi/device/cl/cl_api.h"

namespace lucarne::gi {

Result<ClBuffer> ClBuffer::create(ClContext& context, size_t bytes, const std::byte* lent,
                                  std::string_view what) {
    constexpr const char* kTodo = "raise --device-memory, or lower --points";
    LUCARNE_TRY(context.usable());
    const ClDeviceInfo& info = context.info();
    if (bytes > info.max_buffer_bytes)
        return failed(std::string(what),
                      fmt::format("{} MiB are more than a buffer of {} holds ({} MiB)", bytes >> 20,
                                  info.name, info.max_buffer_bytes >> 20),
                      kTodo);
    LUCARNE_TRY(context.memory().take(bytes, what));
    cl_int problem = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(
        context.context(), lent ? CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR : CL_MEM_READ_WRITE, bytes,
        const_cast<std::byte*>(lent), &problem);  // clCreateBuffer takes no pointer to const
    if (problem != CL_SUCCESS) {
        context.memory().give_back(bytes);
        LUCARNE_TRY(context.check_loss(problem));
        return failed(std::string(what),
                      fmt::format("the OpenCL device has no {} KiB of memory left", (bytes + 1023) >> 10),
                      kTodo);
    }
    ClBuffer made;
    made.context_ = &context;
    made.memory_ = memory;
    made.bytes_ = bytes;
    return made;
}

Result<ClBuffer> ClBuffer::make(ClContext& context, size_t bytes, std::string_view what) {
    return create(context, std::max<size_t>(bytes, 16), nullptr, what);
}

Result<ClBuffer> ClBuffer::lend(ClContext& context, std::span<const std::byte> data,
                                std::shared_ptr<const void> owner, std::string_view what) {
    LUCARNE_ASSIGN(ClBuffer made, create(context, data.size(), data.data(), what));
    made.owner_ = std::move(owner);
    return made;
}

ClBuffer& ClBuffer::operator=(ClBuffer&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    std::swap(owner_, other.owner_);
    return *this;
}

ClBuffer::~ClBuffer() {
    if (!memory_) return;
    if (owner_) clFinish(context_->queue());  // queued work may still read what is lent
    clReleaseMemObject(memory_);              // the driver keeps it until queued work that uses it is done
    context_->memory().give_back(bytes_);
}

Result<void> ClBuffer::upload(size_t offset, std::span<const std::byte> data) {
    if (offset > bytes_ || data.size() > bytes_ - offset)
        return failed("OpenCL", "an upload is larger than its buffer");
    if (data.empty()) return {};
    LUCARNE_TRY(context_->usable());
    context_->set_busy(false);  // the queue is in order, so all earlier work is done as well
    return context_->answered("upload", clEnqueueWriteBuffer(context_->queue(), memory_, CL_TRUE, offset,
                                                             data.size(), data.data(), 0, nullptr, nullptr));
}

Result<void> ClBuffer::download(size_t offset, std::span<std::byte> out) const {
    if (offset > bytes_ || out.size() > bytes_ - offset)
        return failed("OpenCL", "a download is larger than its buffer");
    if (out.empty()) return {};
    LUCARNE_TRY(context_->usable());
    context_->set_busy(false);
    return context_->answered("download", clEnqueueReadBuffer(context_->queue(), memory_, CL_TRUE, offset,
                                                              out.size(), out.data(), 0, nullptr, nullptr));
}

}  // namespace lucarne::gi
