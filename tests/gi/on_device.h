#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "gi/device/device.h"

namespace lucarne::gi {

/// A test that needs OpenGL; skipped only on machines that have no device at all.
class OnDevice : public ::testing::Test {
 protected:
    void SetUp() override {
        auto made = Device::headless();
        if (!made) GTEST_SKIP() << made.error().line();
        device = std::move(*made);
    }
    std::unique_ptr<Device> device;
};

}  // namespace lucarne::gi
