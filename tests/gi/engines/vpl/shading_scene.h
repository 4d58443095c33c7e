// What the tests of native shading, merging and light of the sky share.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "gi/raster/native/native.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {

/// A room whose back wall is in the light of VPLs at its sides, with a bush of discs that have no neighbours
/// of their own surface. The floor is of material 1.
inline std::vector<Surfel> bush_room() {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, glm::vec3(-2, 3, -2), 4.0f * kX, 4.0f * kZ, 120, glm::vec3(0.5f));
    scenes::add_rectangle(surfels, glm::vec3(-2, 0, -1), 4.0f * kX, 4.0f * kY, 120,
                          glm::vec3(0.7f, 0.5f, 0.2f), 1);
    scenes::add_rectangle(surfels, glm::vec3(-2, 0, -1), 4.0f * kY, 3.0f * kZ, 80, glm::vec3(0.5f));
    for (int i = 0; i < 400; ++i) {
        const float a = 2.4f * static_cast<float>(i), z = 0.0025f * static_cast<float>(i) - 0.5f;
        const glm::vec3 normal = glm::normalize(glm::vec3(std::cos(3 * a), -1, std::sin(5 * a)));
        surfels.push_back(
            {{0.5f * std::cos(a), 2 + 0.5f * std::sin(a), z}, normal, glm::vec3(0.5f), 0, 2e-4f, 0});
    }
    return surfels;
}

/// Native passes in that room; skipped on devices that have none.
class InBushRoom : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device->native_passes()) GTEST_SKIP() << "no native passes on this device";
        auto loaded = load_cloud(*device, SurfelCloud(bush_room()));
        ASSERT_TRUE(loaded);
        loaded_ = std::move(*loaded);
    }
    void TearDown() override {
        gi::native::use_instruction_set(-1);
        OnDevice::TearDown();
    }
    std::unique_ptr<LoadedCloud> loaded_;
};

/// Returns how many pixels differ by more than a share of their light and a least distance.
inline size_t different(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b, float share,
                        float least) {
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i)
        count += !(glm::distance(a[i], b[i]) <= share * glm::length(a[i]) + least);
    return count;
}

}  // namespace lucarne::gi::vpl
