// Scans whose stations have different exposures.
#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/synthetic/synthetic.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree::testing {

inline double to_linear(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
inline double to_srgb(double v) {
    return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}
/// An 8-bit colour of a linear one.
inline std::array<uint8_t, 3> code(const glm::dvec3& linear) {
    std::array<uint8_t, 3> bytes{};
    for (int c = 0; c < 3; ++c)
        bytes[static_cast<size_t>(c)] =
            static_cast<uint8_t>(std::lround(255 * to_srgb(std::clamp(linear[c], 0.0, 1.0))));
    return bytes;
}

/// A virtual scan whose colours (u8) are changed record by record.
class Recoloured final : public io::PointSource {
 public:
    /// Takes a point's linear colour, station and record; returns the linear colour to store.
    using Change = std::function<glm::dvec3(const glm::dvec3&, uint32_t, const std::byte*)>;
    Recoloured(const io::SyntheticOptions& options, Change change) : change_(std::move(change)) {
        auto source = io::synthetic_source(options);
        EXPECT_TRUE(source) << (source ? "" : source.error().line());
        source_ = std::move(*source);
        color_ = schema().find(io::names::color);
        station_ = schema().find(io::names::point_source_id);
    }
    const io::Schema& schema() const override { return source_->schema(); }
    const io::ScanInfo& info() const override { return source_->info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        LUCARNE_ASSIGN(auto reader, source_->open());
        return std::make_unique<Reader>(*this, std::move(reader));
    }

 private:
    struct Reader final : io::PointReader {
        Reader(const Recoloured& its_scan, std::unique_ptr<io::PointReader> its_reader)
            : scan(its_scan), reader(std::move(its_reader)) {}
        Result<size_t> read(io::PointBatch& batch, size_t most) override {
            LUCARNE_ASSIGN(const size_t count, reader->read(batch, most));
            for (size_t i = 0; i < count; ++i) scan.change(&batch.bytes[i * scan.schema().stride]);
            return count;
        }
        uint64_t dropped() const override { return reader->dropped(); }
        const Recoloured& scan;
        std::unique_ptr<io::PointReader> reader;
    };
    void change(std::byte* record) const {
        std::byte* at = record + color_->offset;
        glm::dvec3 linear;
        for (int c = 0; c < 3; ++c) linear[c] = to_linear(std::to_integer<int>(at[c]) / 255.0);
        io::store(at, code(change_(linear, io::load<uint16_t>(record + station_->offset), record)));
    }
    std::unique_ptr<io::PointSource> source_;
    Change change_;
    const io::Attribute *color_ = nullptr, *station_ = nullptr;
};

/// A rectangle of the plane z = 0, x from `low` to `high`, y from 0 to 1, with colours u8.
inline test::ComputedSource strip(double low, double high, const glm::dvec3& gain, uint64_t points = 30'000) {
    io::Schema schema;
    schema.add("color", io::ScalarType::u8, 3);
    return {schema, points, [=](uint64_t index, std::byte* record) {
                Random random(31 + static_cast<uint64_t>(1000 * low), index);
                const double x = low + (high - low) * random.uniform(), y = random.uniform();
                io::store(record, glm::dvec3(x, y, 0));
                // A pattern that varies by a factor of 4 within a tenth of the strip's width.
                const double paint = 0.1 * std::exp2(std::sin(40 * x) + std::cos(50 * y));
                io::store(record + 24, code(paint * gain));
            }};
}

inline std::unique_ptr<NodeSource> converted(const std::vector<const io::PointSource*>& sources,
                                             const std::filesystem::path& output, unsigned threads = 2,
                                             NormalsMode normals = NormalsMode::automatic) {
    BuildOptions options;
    options.inputs = sources;
    options.output = output;
    options.normals = normals;
    options.threads = threads;
    const auto report = build_cache(options);
    EXPECT_TRUE(report) << (report ? "" : report.error().line());
    EXPECT_TRUE(verify_cache(output, [](uint64_t) {}));
    auto cache = open_cache(output);
    EXPECT_TRUE(cache) << (cache ? "" : cache.error().line());
    return cache ? std::move(*cache) : nullptr;
}

}  // namespace lucarne::octree::testing
