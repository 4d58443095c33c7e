#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::test {

/// A scan whose points are known by their numbers: a wall in front (x 0 to 4, z 0 to 3, y = 0) with a window
/// (x 1.5 to 2.5, z 1 to 2) and a wall 2 behind it, a point every 0.05. Integers of a thousandth of a US
/// survey foot, far from the origin, as a state plane's coordinates are.
struct MeasuredScan {
    static constexpr double kFoot = 1200.0 / 3937.0, kSpacing = 0.05, kBehind = 2;
    static constexpr int kAcross = 81, kUp = 61, kWall = kAcross * kUp;
    static constexpr glm::dvec3 kOffset{1'500'000, 200'000, 0}, kCorner{1'567'890.123, 245'678.457, 812.006};

    static bool window(const glm::dvec3& p) {
        const double x = p.x - kCorner.x, z = p.z - kCorner.z;
        return x > 1.49 && x < 2.51 && z > 0.99 && z < 2.01;
    }
    /// Returns the integers of the scan's point `number`: thousandths, before the offset.
    static glm::ivec3 integers(uint64_t number) {
        const auto in_wall = static_cast<int>(number % kWall);
        const bool behind = number >= kWall;
        glm::ivec3 p(67'890'123 + in_wall % kAcross * 50, 45'678'457 + (behind ? 2000 : 0),
                     812'006 + in_wall / kAcross * 50);
        const glm::dvec3 place = glm::dvec3(p) * 1e-3 + kOffset;
        if (!behind && window(place))
            p.y += 2000;  // points that would be in the window belong to the wall behind
        return p;
    }
    static glm::dvec3 position(uint64_t number) { return glm::dvec3(integers(number)) * 1e-3 + kOffset; }

    MeasuredScan() {
        io::Schema schema;
        schema.position = io::PositionType::i32_scaled;
        schema.stride = 12;
        schema.scale = glm::dvec3(0.001);
        schema.offset = kOffset;
        schema.add(std::string(io::names::intensity), io::ScalarType::u16);
        schema.add(std::string(io::names::classification), io::ScalarType::u8);
        schema.add(std::string(io::names::gps_time), io::ScalarType::f64);
        schema.add("number", io::ScalarType::u32);
        ComputedSource scan(schema, 2 * kWall, [&](uint64_t i, std::byte* record) {
            const glm::ivec3 p = integers(i);
            io::store(record, p.x);
            io::store(record + 4, p.y);
            io::store(record + 8, p.z);
            io::store<uint16_t>(record + 12, static_cast<uint16_t>(i % 1000));
            io::store<uint8_t>(record + 14, i < kWall ? 6 : 2);
            io::store<double>(record + 15, 300'000'000.125 + 1e-6 * static_cast<double>(i));
            io::store<uint32_t>(record + 23, static_cast<uint32_t>(i));
        });
        scan.info().path = "/survey/walls.las";
        scan.info().metres_per_unit = kFoot;
        scan.info().unit_stated = true;
        octree::BuildOptions options;
        options.inputs = {&scan};
        options.output = file();
        const auto built = octree::build_cache(options);
        EXPECT_TRUE(built) << built.error().line();
        auto opened = octree::open_cache(file());
        EXPECT_TRUE(opened);
        source = std::move(*opened);
    }
    std::filesystem::path file() const { return folder / "walls.luc"; }

    TempFolder folder;
    std::shared_ptr<const octree::NodeSource> source;
};

}  // namespace lucarne::test
