#include "gi/device/cl/cl_kernel.h"

#include <fmt/format.h>

#include "gi/device/cl/cl_api.h"

namespace lucarne::gi {

ClKernel::~ClKernel() {
    if (kernel_) clReleaseKernel(kernel_);
}

void ClKernel::adopt(_cl_kernel* kernel) {
    if (kernel_) clReleaseKernel(kernel_);  // the driver keeps it until its queued runs are done
    kernel_ = kernel;
    cl_ulong local = 0;
    const cl_int code = clGetKernelWorkGroupInfo(kernel_, context_.id(), CL_KERNEL_LOCAL_MEM_SIZE,
                                                 sizeof local, &local, nullptr);
    own_local_ = code == CL_SUCCESS ? local : 0;
}

Result<void> ClKernel::check_local(size_t bytes) const {
    const uint64_t most = context_.info().local_memory;
    if (bytes == 0 || (own_local_ <= most && bytes <= most - own_local_)) return {};
    return failed(name_,
                  fmt::format("{} bytes of local memory are more than a group has on {} ({} bytes)",
                              own_local_ + bytes, context_.info().name, most),
                  "it is a fault of the program");
}

Result<void> ClKernel::set(uint32_t index, const ClBuffer& buffer) const {
    return set_bytes(index, &buffer.memory_, sizeof buffer.memory_);
}

Result<void> ClKernel::set_bytes(uint32_t index, const void* value, size_t bytes) const {
    if (clSetKernelArg(kernel_, index, bytes, value) == CL_SUCCESS) return {};
    return failed(name_, fmt::format("argument {} does not fit", index), "it is a fault of the program");
}

Result<void> ClKernel::enqueue(const ClRange& range) const {
    std::array<size_t, 3> items = range.items;
    const auto& group = range.group;
    if (std::ranges::count(items, size_t{0}) > 0) return {};
    const bool grouped = std::ranges::count(group, size_t{0}) == 0;
    uint64_t room = context_.info().max_group_size;
    for (size_t i = 0; grouped && i < items.size(); ++i) {
        if (group[i] > room)
            return failed(
                name_,
                fmt::format("{} x {} x {} work-items are more than a group has on {} ({})", group[0],
                            group[1], group[2], context_.info().name, context_.info().max_group_size),
                "it is a fault of the program");
        room /= group[i];
        items[i] = (items[i] + group[i] - 1) / group[i] * group[i];
    }
    LUCARNE_TRY(context_.usable());
    context_.set_busy(true);
    return context_.answered(
        name_, clEnqueueNDRangeKernel(context_.queue(), kernel_, range.dimensions, nullptr, items.data(),
                                      grouped ? group.data() : nullptr, 0, nullptr, nullptr));
}

}  // namespace lucarne::gi
