#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "gi/device/gl/device.h"

namespace lucarne::gi {

/// A test that needs OpenGL. It fails where no device opens: Mesa's software devices run everywhere.
class OnDevice : public ::testing::Test {
 protected:
    void SetUp() override {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device = std::move(*made);
    }
    std::unique_ptr<Device> device;
};

}  // namespace lucarne::gi
