#pragma once

#include <memory>

#include "gi/device/cl/cl_device.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {

/// A test with an OpenCL device beside the OpenGL device.
class OnOpenCl : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device) return;
        auto opened = ClDevice::open(*device);
        ASSERT_TRUE(opened) << opened.error().line();
        opencl = std::move(*opened);
    }
    void TearDown() override {
        opencl.reset();
        OnDevice::TearDown();
    }
    std::unique_ptr<ClDevice> opencl;
};

}  // namespace lucarne::gi
