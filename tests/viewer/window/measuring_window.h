// Clicks two points of known coordinates in a real window.
#pragma once

#include <fstream>

#include <fmt/format.h>

#include "tests/viewer/measure/measured_scan.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne::test {

class MeasuringWindow : public ViewerWindow {
 protected:
    /// With the scan's wall in front of the camera, measures by two clicks and saves the file.
    void measure_a_known_distance(const std::string& options = "") {
        cache_ = scan_.file();
        const std::string scene = folder_ / "front.json";
        std::ofstream(scene) << fmt::format(
            R"({{"cameras": [{{"name": "front", "position": [{0}, {1}, {2}], "target": [{0}, {3}, {2}], "fov": 50}}],
            "lights": [{{"type": "point", "position": [{0}, {1}, {2}], "intensity": [50, 50, 50]}}]}})",
            from_.x, from_.y, from_.z, from_.y + 4);
        start(" --scene " + scene + options);
        ASSERT_TRUE(picture(lit));
        xdo("key Tab");
        xdo("key ctrl+2");
        // Points of the front wall: 10th and 66th of the third row.
        const uint64_t a = 9 + 2 * MeasuredScan::kAcross, b = 65 + 2 * MeasuredScan::kAcross;
        click(a);
        click(b);
        const std::string file = folder_ / "measurements.csv";
        ASSERT_TRUE(eventually([&] {
            xdo("key ctrl+e sleep 0.3");
            return !viewer_->running() || std::filesystem::exists(file);
        })) << "nothing was measured";
        const std::string csv = bytes_of(file);
        EXPECT_THAT(csv, testing::HasSubstr("Distance 1,distance,point 1,,," + digits(a)));
        EXPECT_THAT(csv, testing::HasSubstr("Distance 1,distance,point 2,,," + digits(b)));
        const size_t at = csv.find("Distance 1,distance,length,");
        ASSERT_NE(at, std::string::npos) << csv;
        EXPECT_NEAR(std::stod(csv.substr(at + 27)), 56 * 0.05 * MeasuredScan::kFoot, 1e-9) << "metres";
    }

 private:
    /// Clicks the point of the front wall with this number.
    void click(uint64_t number) const {
        const glm::dvec3 d = MeasuredScan::position(number) - from_;
        const double half = std::tan(25.0 / 180 * M_PI);
        const double x = scale_ * (kWidth / 2.0 + d.x / d.y / half * kHeight / 2.0);
        const double y = scale_ * (kHeight / 2.0 - d.z / d.y / half * kHeight / 2.0);
        EXPECT_EQ(xdo(fmt::format("mousemove {:.0f} {:.0f} sleep 0.4 click 1 sleep 0.4", std::floor(x),
                                  std::floor(y)))
                      .code,
                  0);
    }
    static std::string digits(uint64_t number) {
        const glm::ivec3 p = MeasuredScan::integers(number);
        return fmt::format("{}.{:03},{}.{:03},{}.{:03}", 1'500'000 + p.x / 1000, p.x % 1000,
                           200'000 + p.y / 1000, p.y % 1000, p.z / 1000, p.z % 1000);
    }

    const MeasuredScan scan_;
    const glm::dvec3 from_ = MeasuredScan::kCorner + glm::dvec3(2, -4, 1.5);
};

}  // namespace lucarne::test
