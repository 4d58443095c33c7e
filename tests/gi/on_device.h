#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "gi/device/gl/device.h"

namespace lucarne::gi {

/// Fixture of tests that need OpenGL. The test fails if no device opens, because Mesa's software devices run
/// everywhere.
class OnDevice : public ::testing::Test {
 protected:
    void SetUp() override {
        auto made = Device::headless();
        ASSERT_TRUE(made) << made.error().line();
        device = std::move(*made);
    }
    void TearDown() override {
        if (!device || lost_on_purpose) return;
        const auto sound = device->check();
        EXPECT_TRUE(sound) << sound.error().line();
    }
    std::unique_ptr<Device> device;
    bool lost_on_purpose = false;
};

}  // namespace lucarne::gi
