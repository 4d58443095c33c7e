#include "gi/device/cl/cl_choice.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "gi/device/cl/cl_api.h"

namespace lucarne::gi {
namespace {

constexpr const char* kInstall = "install the graphics driver's OpenCL, or Debian's pocl-opencl-icd";
constexpr const char* kVariable = "LUCARNE_CL_DEVICE";

/// Returns the devices of all platforms: GPUs, then processors, then others.
std::vector<cl_device_id> all_devices() {
    std::vector<cl_device_id> all;
    cl_uint count = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return all;
    std::vector<cl_platform_id> platforms(count);
    if (clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS) return all;
    for (const cl_device_type kind : {CL_DEVICE_TYPE_GPU, CL_DEVICE_TYPE_CPU, CL_DEVICE_TYPE_ACCELERATOR})
        for (const cl_platform_id platform : platforms) {
            cl_uint found = 0;
            if (clGetDeviceIDs(platform, kind, 0, nullptr, &found) != CL_SUCCESS || found == 0) continue;
            std::vector<cl_device_id> devices(found);
            if (clGetDeviceIDs(platform, kind, found, devices.data(), nullptr) != CL_SUCCESS) continue;
            all.insert(all.end(), devices.begin(), devices.end());
        }
    return all;
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    return lower;
}

}  // namespace

Result<void> opencl_available() {
    LUCARNE_TRY(choose_cl_device());
    return {};
}

Result<_cl_device_id*> choose_cl_device() {
    const std::vector<cl_device_id> devices = all_devices();
    if (devices.empty()) return failed("OpenCL", "no device was found", kInstall);
    const char* variable = std::getenv(kVariable);
    const std::string wanted = lower_case(variable ? variable : "");
    if (wanted.empty()) return devices.front();
    std::string names;
    for (const cl_device_id device : devices) {
        const std::string name = cl_text(device, CL_DEVICE_NAME);
        if (lower_case(name).find(wanted) != std::string::npos) return device;
        names += (names.empty() ? "" : ", ") + name;
    }
    return failed("OpenCL", fmt::format("no device has the name \"{}\" ({})", variable, kVariable),
                  fmt::format("there are: {}", names));
}

std::string cl_text(_cl_device_id* device, uint32_t what) {
    size_t bytes = 0;
    if (clGetDeviceInfo(device, what, 0, nullptr, &bytes) != CL_SUCCESS || bytes == 0) return {};
    std::string text(bytes, '\0');
    clGetDeviceInfo(device, what, bytes, text.data(), nullptr);
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    return text;
}

}  // namespace lucarne::gi
