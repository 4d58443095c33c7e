#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "gi/device/gl/device.h"
#include "tests/viewer/program.h"
#include "viewer/inputs/input.h"

namespace lucarne::test {

/// A test with a device and a small cache, whose holes are filled.
class WithCornell : public testing::Test {
 protected:
    void SetUp() override {
        auto device = gi::Device::headless();
        ASSERT_TRUE(device) << device.error().line();
        device_ = std::move(*device);
        const auto source = viewer::open_input(make_cornell(folder_, "60k"));
        ASSERT_TRUE(source) << source.error().line();
        source_ = *source;
    }
    TemporaryFolder folder_;
    std::unique_ptr<gi::Device> device_;
    std::shared_ptr<const octree::NodeSource> source_;
};

}  // namespace lucarne::test
