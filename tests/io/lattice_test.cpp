// Which lattice of 32-bit integers holds given coordinates to their last digit.
#include "io/lattice.h"

#include <cmath>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::io {
namespace {

struct Cloud {
    Schema schema;
    std::vector<std::byte> records;
    PositionBox box{glm::dvec3(1e300), glm::dvec3(-1e300)};

    explicit Cloud(PositionType type) {
        schema.position = type;
        schema.stride = static_cast<uint32_t>(position_bytes(type));
    }
    void add(const glm::dvec3& p) {
        records.resize(records.size() + schema.stride);
        std::byte* at = &records[records.size() - schema.stride];
        for (int axis = 0; axis < 3; ++axis)
            if (schema.position == PositionType::f32)
                store(at + 4 * axis, static_cast<float>(p[axis]));
            else
                store(at + 8 * axis, p[axis]);
        const glm::dvec3 stored = position_of(schema, at);
        box = {glm::min(box[0], stored), glm::max(box[1], stored)};
    }
    Lattice found() const {
        DecimalSearch search(schema, box);
        search.add(records);
        return search.found();
    }
    /// Returns the largest distance of a coordinate from its nearest lattice position.
    double distance(const Lattice& lattice) const {
        double most = 0;
        for (size_t at = 0; at < records.size(); at += schema.stride) {
            const glm::dvec3 p = position_of(schema, &records[at]);
            for (int axis = 0; axis < 3; ++axis) {
                const double whole = std::nearbyint((p[axis] - lattice.offset[axis]) / lattice.scale[axis]);
                EXPECT_LE(std::abs(whole), 2147483647.0);
                most = std::max(most, std::abs(whole * lattice.scale[axis] + lattice.offset[axis] - p[axis]));
            }
        }
        return most;
    }
};

TEST(Lattice, CoordinatesOfUtmSwissAndFootGridsKeepTheDecimalsTheyHave) {
    struct Case {
        glm::dvec3 corner;
        int digits, found;
    };
    for (const Case& c : {Case{{500'000, 5'400'000, 100}, 3, 3}, Case{{2'600'000, 1'200'000, 400}, 4, 4},
                          Case{{7'650'000, 650'000, 300}, 2, 3}, Case{{-35.5, 12, 0}, 6, 6}}) {
        Cloud cloud(PositionType::f64);
        const double power = std::pow(10, c.digits);
        for (uint64_t i = 0; i < 1000; ++i) {
            Random random(1, i);
            glm::dvec3 p;
            for (int axis = 0; axis < 3; ++axis)
                p[axis] = std::nearbyint((c.corner[axis] + 500 * random.uniform()) * power) / power;
            cloud.add(p);
        }
        const Lattice lattice = cloud.found();
        for (int axis = 0; axis < 3; ++axis) EXPECT_DOUBLE_EQ(lattice.scale[axis], std::pow(10, -c.found));
        EXPECT_LT(cloud.distance(lattice), 1e-8);
    }
}

TEST(Lattice, FloatsThatWereDecimalsGetThoseDecimals) {
    Cloud cloud(PositionType::f32);
    for (uint64_t i = 0; i < 1000; ++i) {
        Random random(2, i);
        cloud.add(glm::dvec3(std::nearbyint(4e4 * random.uniform()) / 1e4));
    }
    EXPECT_EQ(cloud.found().scale, glm::dvec3(1e-4));
}

TEST(Lattice, WhatNoDecimalsHoldGetsTheFinestThatTheBoxAllows) {
    Cloud cloud(PositionType::f64);
    DecimalSearch bare(cloud.schema, {glm::dvec3(0), glm::dvec3(1)});
    EXPECT_DOUBLE_EQ(bare.found().scale.x, 1e-9);  // only the box is known
    for (uint64_t i = 0; i < 1000; ++i) {
        Random random(3, i);
        cloud.add({random.uniform(), 1000 * random.uniform(), std::nearbyint(100 * random.uniform()) / 100});
    }
    DecimalSearch search(cloud.schema, cloud.box);
    EXPECT_TRUE(search.add(cloud.records));  // z may still be decimal
    const Lattice lattice = search.found();
    EXPECT_DOUBLE_EQ(lattice.scale.x, 1e-9);
    EXPECT_DOUBLE_EQ(lattice.scale.y, 1e-6);
    EXPECT_DOUBLE_EQ(lattice.scale.z, 1e-3);
    EXPECT_LE(cloud.distance(lattice), 0.51e-6);
}

TEST(Lattice, BoxesOfAnySizeFitIntoIntegers) {
    for (const double size : {0.0, 1e-20, 1e-6, 1.0, 1e6, 1e12, 1e30})
        for (const double corner : {0.0, -1e3, 5.4e6, 1e30}) {
            Cloud cloud(PositionType::f64);
            cloud.add(glm::dvec3(corner));
            cloud.add(glm::dvec3(corner + size));
            cloud.add(glm::dvec3(corner + size / 3));
            const double largest = std::max(std::abs(corner), std::abs(corner + size));
            EXPECT_LE(cloud.distance(cloud.found()), std::max(1e-9 * size, 1e-12 + 1e-14 * largest))
                << size << " at " << corner;
        }
}

TEST(Lattice, FilesOfOneLatticeShareItThoughTheirScalesAndOffsetsDiffer) {
    const PositionBox box{glm::dvec3(500'000), glm::dvec3(501'000)};
    const double foot = 0.3048 / 256;  // its multiples are no decimal fractions
    const std::array same = {Lattice{glm::dvec3(4 * foot), glm::dvec3(500'000)},
                             Lattice{glm::dvec3(foot), glm::dvec3(500'000 + 1e5 * foot)}};
    const auto common = common_lattice(same, box);
    ASSERT_TRUE(common);
    EXPECT_EQ(common->scale, glm::dvec3(foot));
    EXPECT_EQ(common->offset, glm::dvec3(500'000));
    const std::array apart = {Lattice{glm::dvec3(0.01), glm::dvec3(0.0)},
                              Lattice{glm::dvec3(0.01), glm::dvec3(0.005)}};
    EXPECT_FALSE(common_lattice(apart, box));
    const std::array other = {Lattice{glm::dvec3(0.01), glm::dvec3(0.0)},
                              Lattice{glm::dvec3(0.015), glm::dvec3(0.0)}};
    EXPECT_FALSE(common_lattice(other, box));
    EXPECT_FALSE(common_lattice({}, box));
}

TEST(Lattice, AnOffsetFarFromTheBoxIsMovedByWholeSteps) {
    const std::array far = {Lattice{glm::dvec3(0.001), glm::dvec3(0.0)}};
    const auto moved = common_lattice(far, {glm::dvec3(5'400'000), glm::dvec3(5'401'000)});
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->offset, glm::dvec3(5'400'500));
    EXPECT_FALSE(common_lattice(far, {glm::dvec3(-5'400'000), glm::dvec3(5'400'000)}));
}

}  // namespace
}  // namespace lucarne::io
