#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <string>
#include <type_traits>

#include "gi/device/cl/cl_buffer.h"
#include "gi/device/cl/cl_context.h"
#include "io/core/error.h"

struct _cl_kernel;

namespace lucarne::gi {

/// How many work-items run, and in groups of which size: `ClRange(count, 64)`, `ClRange({width, height},
/// {8, 8})`. Without a group size the driver chooses one.
struct ClRange {
    explicit ClRange(size_t count, size_t group_size = 0)
        : items{count, 1, 1}, group{group_size, 1, 1}, dimensions(1) {}
    template <size_t N>
    requires(N >= 2 && N <= 3) explicit ClRange(const size_t (&counts)[N]) : dimensions(N) {
        std::copy_n(counts, N, items.begin());
        group[0] = 0;
    }
    template <size_t N>
    requires(N >= 2 && N <= 3) ClRange(const size_t (&counts)[N], const size_t (&group_size)[N])
        : dimensions(N) {
        std::copy_n(counts, N, items.begin());
        std::copy_n(group_size, N, group.begin());
    }

    std::array<size_t, 3> items = {1, 1, 1};  ///< those of unused dimensions are 1
    std::array<size_t, 3> group = {1, 1, 1};  ///< a zero: the driver chooses all
    uint32_t dimensions;                      ///< 1 to 3
};

/// An argument for a `local` pointer: memory that the work-items of a group share.
struct ClLocal {
    size_t bytes;
};

/// A structure of 16 bytes that a kernel takes by value: glm::vec4, glm::uvec4 or one of the shared headers.
template <class T>
concept ClStruct = std::is_class_v<T> && std::is_trivially_copyable_v<T> && sizeof(T) == 16 &&
                   !std::ranges::borrowed_range<T>;  // no span: its pointer means nothing on the device

/// A kernel function of a compiled program. Its ClDevice owns it; it stays at its address when programs are
/// compiled again, so engines may keep a pointer.
class ClKernel {
 public:
    ~ClKernel();
    ClKernel(const ClKernel&) = delete;
    ClKernel& operator=(const ClKernel&) = delete;
    /// Sets the arguments in order and runs a work-item for each element of `range`, whose items are rounded
    /// up to whole groups in each dimension; without items it does nothing. Arguments are ClBuffers,
    /// ClLocals, uint32_t, int32_t, float and ClStructs. Does not wait. Errors: an argument does not fit,
    /// more local memory or a larger group than the device has, the device failed.
    template <class... Arguments>
    Result<void> run(const ClRange& range, const Arguments&... arguments) const {
        uint32_t index = 0;
        Result<void> done = check_local((local_bytes(arguments) + ... + size_t{0}));
        ((done = done ? set(index++, arguments) : done), ...);
        return done ? enqueue(range) : done;
    }

 private:
    friend class ClProgram;
    ClKernel(ClContext& context, std::string name) : context_(context), name_(std::move(name)) {}
    /// Takes ownership of `kernel` and releases what it had.
    void adopt(_cl_kernel* kernel);

    template <class T>
    static size_t local_bytes(const T& argument) {
        if constexpr (std::is_same_v<T, ClLocal>) return argument.bytes;
        return 0;
    }
    Result<void> check_local(size_t bytes) const;
    Result<void> set(uint32_t index, const ClBuffer& buffer) const;
    Result<void> set(uint32_t index, ClLocal local) const { return set_bytes(index, nullptr, local.bytes); }
    Result<void> set(uint32_t index, uint32_t value) const { return set_bytes(index, &value, sizeof value); }
    Result<void> set(uint32_t index, int32_t value) const { return set_bytes(index, &value, sizeof value); }
    Result<void> set(uint32_t index, float value) const { return set_bytes(index, &value, sizeof value); }
    template <ClStruct T>
    Result<void> set(uint32_t index, const T& value) const {
        return set_bytes(index, &value, sizeof value);
    }
    Result<void> set_bytes(uint32_t index, const void* value, size_t bytes) const;
    Result<void> enqueue(const ClRange& range) const;

    ClContext& context_;
    std::string name_;  ///< for errors: "kernel gather of gi/engines/micro/gather.cl"
    _cl_kernel* kernel_ = nullptr;
    size_t own_local_ = 0;  ///< bytes of local memory that the kernel declares itself
};

}  // namespace lucarne::gi
