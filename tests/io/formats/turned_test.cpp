#include "io/formats/turned.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/formats/scan.h"
#include "tests/temporary_folder.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

class Turned : public ::testing::Test {
 protected:
    /// Opens a PLY of one point with a normal.
    std::unique_ptr<PointSource> open(UpAxis up) const {
        const auto path = folder_ / "point.ply";
        std::ofstream(path) << "ply\nformat ascii 1.0\nelement vertex 1\n"
                               "property float x\nproperty float y\nproperty float z\n"
                               "property float nx\nproperty float ny\nproperty float nz\nend_header\n"
                               "1 2 3 0 0.6 0.8\n";
        ReadOptions options;
        options.up = up;
        auto scan = open_scan(path, options);
        EXPECT_TRUE(scan) << scan.error().line();
        return std::move(*scan);
    }
    static PointBatch points(const PointSource& scan) {
        PointBatch batch;
        const auto reader = scan.open();
        EXPECT_TRUE(reader && (*reader)->read(batch, 10));
        return batch;
    }
    const test::Folder folder_;
};

TEST_F(Turned, TheGivenAxisPointsUpAndNothingIsMirrored) {
    const dvec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    for (const char* name : {"x", "y", "z", "-x", "-y", "-z"}) {
        const auto up = up_axis(name);
        ASSERT_TRUE(up) << name;
        EXPECT_EQ(up_axis_name(*up), name);
        const auto scan = open(*up);
        const PointBatch batch = points(*scan);
        ASSERT_EQ(batch.count, 1u);
        const dvec3 position = position_of(scan->schema(), batch.bytes.data());
        EXPECT_EQ(position.z, dot(dvec3(1, 2, 3), axes[static_cast<size_t>(*up)])) << name;
        EXPECT_EQ(dot(position, position), 14) << name;
        const Attribute* normal = scan->schema().find(names::normal);
        ASSERT_TRUE(normal);
        dvec3 n;
        for (int i = 0; i < 3; ++i)
            n[i] =
                scalar_at(normal->type,
                          &batch.bytes[normal->offset + static_cast<size_t>(i) * scalar_bytes(normal->type)]);
        for (int i = 0; i < 3; ++i) EXPECT_FALSE(n[i] == 0 && std::signbit(n[i])) << name << ": prints as -0";
        EXPECT_NEAR(dot(n, position), dot(dvec3(0, .6, .8), dvec3(1, 2, 3)), 1e-6) << name;
    }
    EXPECT_FALSE(up_axis("w"));
}

TEST_F(Turned, ACacheOfAnotherAxisIsNotUsedByMistake) {
    ReadOptions options;
    EXPECT_EQ(options_text(options), "");
    options.up = UpAxis::minus_y;
    EXPECT_EQ(options_text(options), "--up -y");
}

/// Points as LAS stores them.
class Scaled final : public PointSource {
 public:
    Scaled() {
        schema_.position = PositionType::i32_scaled;
        schema_.scale = {.001, .01, .1};
        schema_.offset = {10, 20, 30};
        schema_.stride = position_bytes(PositionType::i32_scaled);
        info_.stations = {{7, {1, 2, 3}}};
        info_.stated_box = {dvec3(-1, -2, -3), dvec3(4, 5, 6)};
    }
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return failed("scaled", "is picked only"); }
    bool seekable() const override { return true; }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        batch.count = indices.size();
        batch.bytes.resize(batch.count * schema_.stride);
        for (size_t i = 0; i < batch.count; ++i)
            for (size_t axis = 0; axis < 3; ++axis)
                store<int32_t>(&batch.bytes[i * schema_.stride + 4 * axis],
                               indices[i] ? std::numeric_limits<int32_t>::min() : static_cast<int32_t>(axis));
        return {};
    }

 private:
    Schema schema_;
    ScanInfo info_;
};

TEST_F(Turned, ScaledIntegersStayExactAndStationsAndBoxesFollow) {
    const auto scan = turned(std::make_unique<Scaled>(), UpAxis::y);
    PointBatch batch;
    const uint64_t both[] = {0, 1};
    ASSERT_TRUE(scan->pick(both, batch));
    EXPECT_EQ(position_of(scan->schema(), batch.bytes.data()), dvec3(10, -(2 * .1 + 30), 1 * .01 + 20));
    const double least = -2147483648.0;
    EXPECT_NEAR(position_of(scan->schema(), &batch.bytes[scan->schema().stride]).y, -(least * .1 + 30), .2)
        << "one step away at most";
    EXPECT_EQ(scan->info().stations.at(0).position, dvec3(1, -3, 2));
    EXPECT_EQ((*scan->info().stated_box)[0], dvec3(-1, -6, -2));
    EXPECT_EQ((*scan->info().stated_box)[1], dvec3(4, 3, 5));
    EXPECT_TRUE(scan->seekable());
}

}  // namespace
}  // namespace lucarne::io
