// Photographs of real rooms, as two stations of different exposure would have taken them.
#include <cstring>

#include "io/formats/scan.h"
#include "tests/octree/colours/coloured_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;

/// Every 16th point of a scan from `first` on, with its colours (16 bits) multiplied by a gain.
class Part final : public io::PointSource {
 public:
    Part(const io::PointSource& whole, size_t first, const glm::dvec3& gain)
        : whole_(whole), first_(first), gain_(gain), color_(whole.schema().find(io::names::color)) {}
    const io::Schema& schema() const override { return whole_.schema(); }
    const io::ScanInfo& info() const override { return whole_.info(); }
    Result<std::unique_ptr<io::PointReader>> open() const override {
        LUCARNE_ASSIGN(auto reader, whole_.open());
        return std::make_unique<Reader>(*this, std::move(reader));
    }

 private:
    struct Reader final : io::PointReader {
        Reader(const Part& its_part, std::unique_ptr<io::PointReader> its_reader)
            : part(its_part), reader(std::move(its_reader)) {}
        Result<size_t> read(io::PointBatch& batch, size_t most) override {
            const size_t stride = part.schema().stride;
            for (;;) {
                LUCARNE_ASSIGN(const size_t count, reader->read(batch, most));
                size_t kept = 0;
                for (size_t i = 0; i < count; ++i)
                    if (next++ % 16 == part.first_) {
                        std::byte* record = &batch.bytes[kept++ * stride];
                        std::memmove(record, &batch.bytes[i * stride], stride);
                        part.expose(record + part.color_->offset);
                    }
                batch.count = kept;
                batch.bytes.resize(kept * stride);
                if (kept > 0 || count == 0) return kept;
            }
        }
        uint64_t dropped() const override { return 0; }
        const Part& part;
        std::unique_ptr<io::PointReader> reader;
        uint64_t next = 0;
    };
    void expose(std::byte* at) const {
        for (int c = 0; c < 3; ++c, at += 2) {
            const double linear = gain_[c] * to_linear(io::load<uint16_t>(at) / 65535.0);
            io::store(at, static_cast<uint16_t>(257 * std::lround(255 * to_srgb(std::min(linear, 1.0)))));
        }
    }
    const io::PointSource& whole_;
    size_t first_;
    glm::dvec3 gain_;
    const io::Attribute* color_;
};

class RealRooms : public ::testing::TestWithParam<std::pair<const char*, bool>> {};
INSTANTIATE_TEST_SUITE_P(All, RealRooms,
                         ::testing::Values(std::pair{"loft.laz", true}, std::pair{"vault.laz", false}));

TEST_P(RealRooms, GiveTheGainsBackAndShowWhetherAllPointsWerePhotographed) {
    const auto& [name, black] = GetParam();
    const auto data = io::testing::shared_data();
    if (data.empty() || !std::filesystem::exists(data / "interiors" / name))
        GTEST_SKIP() << "no shared " << name;
    const auto scan = io::open_scan(data / "interiors" / name);
    ASSERT_TRUE(scan) << scan.error().line();
    const glm::dvec3 gain(0.55, 0.6, 0.75);
    const Part first(**scan, 3, glm::dvec3(1)), second(**scan, 11, gain);
    const test::TempFolder folder;
    const auto cache = converted({&first, &second}, folder / "a.luc", 2, NormalsMode::none);
    ASSERT_TRUE(cache);
    const auto& colours = cache->header().station_colours;
    ASSERT_EQ(colours.size(), 2u);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(colours[0].gain[c] / colours[1].gain[c] / gain[c], 1, 0.02) << c;
        EXPECT_NEAR(colours[0].gain[c] * colours[1].gain[c], 1, 0.001) << c;
    }
    for (const StationColour& colour : colours) EXPECT_EQ(colour.unphotographed.has_value(), black);
}

}  // namespace
}  // namespace lucarne::octree
