#pragma once

#include "gi/device/cl/cl_device.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {

/// A test with an OpenCL device beside the OpenGL device.
class OnOpenCl : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device) return;
        const auto opened = device->opencl();
        ASSERT_TRUE(opened) << opened.error().line();
        opencl = *opened;
    }
    ClDevice* opencl = nullptr;
};

}  // namespace lucarne::gi
