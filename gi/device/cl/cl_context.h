#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "gi/device/common/memory_budget.h"
#include "io/core/error.h"

// OpenCL's handles, declared forward so that only .cpp files of this folder include its headers.
struct _cl_context;
struct _cl_command_queue;
struct _cl_device_id;

namespace lucarne::gi {

struct ClDeviceInfo {
    std::string name, platform, driver;
    uint32_t units = 0;
    uint64_t memory = 0, max_buffer_bytes = 0;
    uint64_t local_memory = 0;    ///< bytes that the work-items of a group share (`local`)
    uint64_t max_group_size = 0;  ///< work-items of a group, over all dimensions; a kernel may allow fewer
    bool is_gpu = false;
};

/// The context and the in-order queue of an OpenCL device, and whether it was lost. ClDevice owns it;
/// buffers, kernels and programs call the driver through it.
class ClContext {
 public:
    using ReportLoss = std::function<void(std::string why)>;
    /// Opens the device of choose_cl_device(). Errors: there is none, or it fails.
    static Result<std::unique_ptr<ClContext>> open(MemoryBudget& memory, ReportLoss report_loss);
    ~ClContext();
    ClContext(const ClContext&) = delete;
    ClContext& operator=(const ClContext&) = delete;

    const ClDeviceInfo& info() const { return info_; }
    MemoryBudget& memory() const { return memory_; }
    _cl_device_id* id() const { return id_; }
    _cl_context* context() const { return context_; }
    _cl_command_queue* queue() const { return queue_; }

    /// Errors: the device was lost earlier. Call it before the driver.
    Result<void> usable() const;
    /// Turns the driver's answer to an upload, download, run or wait into a result.
    Result<void> answered(std::string_view what, int code);
    /// Errors: the answer, or a message of the driver, comes from a lost device. Reports that as well.
    Result<void> check_loss(int code);
    Error device_error(std::string_view what, int code) const;

    /// Whether work was queued for which nobody has waited.
    bool is_busy() const { return busy_; }
    void set_busy(bool busy) { busy_ = busy; }
    /// Waits until all queued work is done. Errors: the device failed.
    Result<void> finish();
    /// For tests, see ClDevice::lose_after().
    void lose_after(uint32_t calls) { calls_left_ = calls; }

 private:
    ClContext(MemoryBudget& memory, ReportLoss report_loss)
        : memory_(memory), report_loss_(std::move(report_loss)) {}
    /// The context's error callback; drivers call it on any thread.
    static void keep_message(const char* message, const void*, size_t, void* context);
    std::string take_message();

    MemoryBudget& memory_;
    ReportLoss report_loss_;
    ClDeviceInfo info_;
    _cl_device_id* id_ = nullptr;
    _cl_context* context_ = nullptr;
    _cl_command_queue* queue_ = nullptr;
    bool busy_ = false;
    std::optional<Error> lost_;
    std::optional<uint32_t> calls_left_;  ///< see lose_after()
    std::mutex message_mutex_;
    std::string message_;  ///< the driver's first since take_message()
};

}  // namespace lucarne::gi
