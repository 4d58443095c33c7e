#include "viewer/picking/pick.h"

#include <random>
#include <semaphore>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/viewer/measure/measured_scan.h"
#include "viewer/measure/marks.h"

namespace lucarne::viewer {
namespace {

using test::MeasuredScan;

std::string field(const ExactPoint& point, std::string_view name) {
    const auto found = std::ranges::find(point.fields, name, &PointField::name);
    return found == point.fields.end() ? "missing" : found->value;
}

std::string in_thousandths(int64_t number) {
    std::string digits = std::to_string(number);
    return digits.insert(digits.size() - 3, ".");
}

class Pick : public testing::Test {
 protected:
    static void SetUpTestSuite() { scan_ = new MeasuredScan; }
    static void TearDownTestSuite() { delete std::exchange(scan_, nullptr); }

    /// Returns the complete picture seen from a place relative to the front wall's corner.
    std::shared_ptr<const Picture> look(const glm::dvec3& from, const glm::dvec3& to,
                                        const gi::Look& how = {}) {
        return look_at(scan_->source, MeasuredScan::kCorner + from, MeasuredScan::kCorner + to, how);
    }
    static std::shared_ptr<const Picture> look_at(const std::shared_ptr<const octree::NodeSource>& source,
                                                  const glm::dvec3& from, const glm::dvec3& to,
                                                  const gi::Look& how = {}) {
        std::counting_semaphore<> published(0);
        const auto worker = PictureWorker::start({[] { return gi::Device::headless(); }, [] {}}, source, {},
                                                 [&] { published.release(); });
        if (!worker) return nullptr;
        PictureRequest request;
        request.method.engine = "direct";
        const auto& header = source->header();
        request.scene = gi::default_scene(header.min, header.max, header.metres_per_unit);
        request.scene.look = how;
        request.frame.camera.position = from;
        request.frame.camera.target = to;
        request.frame.size = {400, 300};
        (*worker)->request(request);
        for (;;) {
            published.acquire();
            if (!(*worker)->error()) return nullptr;
            const auto picture = (*worker)->latest();
            if (picture && picture->stats.nodes_pending == 0) return picture;
        }
    }
    static MeasuredScan* scan_;
    NodeCache cache_{scan_->source};
};
MeasuredScan* Pick::scan_ = nullptr;

TEST_F(Pick, GivesTheVeryPointThatWasScannedWithItsLastDigitAndAllItsAttributes) {
    const auto picture = look({2, -4, 1.5}, {2, 0, 1.5});
    ASSERT_TRUE(picture);
    int seen = 0;
    for (uint64_t number = 0; number < MeasuredScan::kWall; number += 7) {
        const glm::dvec3 position = MeasuredScan::position(number);
        const auto projected = project(*picture, position);
        if (!projected || projected->pixel.x < 5 || projected->pixel.y < 5 || projected->pixel.x > 395 ||
            projected->pixel.y > 295 || MeasuredScan::window(position))
            continue;
        const glm::dvec2 place = projected->pixel / glm::dvec2(400, 300);
        const auto picked = pick_point(*picture, place, cache_);
        ASSERT_TRUE(picked);
        ASSERT_TRUE(*picked) << number;
        const ExactPoint& point = (*picked)->point;
        ++seen;
        ASSERT_EQ(field(point, "number"), std::to_string(number));
        const glm::ivec3 integers = MeasuredScan::integers(number);
        EXPECT_EQ(point.coordinates[0], in_thousandths(1'500'000'000 + int64_t{integers.x}));
        EXPECT_EQ(point.coordinates[1], in_thousandths(200'000'000 + int64_t{integers.y}));
        EXPECT_EQ(point.coordinates[2], in_thousandths(integers.z));
        EXPECT_LE(glm::distance(point.position, position), 5e-10) << "a double's last bit at most";
        EXPECT_EQ(field(point, "classification"), "6 Building");
        EXPECT_EQ(field(point, "intensity"), std::to_string(number % 1000));
        EXPECT_EQ(field(point, "scan"), "walls.las");
        EXPECT_EQ(std::stod(field(point, "gps_time")), 300'000'000.125 + 1e-6 * static_cast<double>(number));
        EXPECT_NE(field(point, "normal (estimated)"), "missing");
    }
    EXPECT_GT(seen, 300);
}

TEST_F(Pick, NeverTakesAPointThatAWallHides) {
    // Over a corner of the window, so that the edge of the wall runs through the picture.
    const glm::dvec3 from(0.7, -3, 1.2);
    const auto picture = look(from, {2.2, 0, 1.7});
    ASSERT_TRUE(picture);
    const glm::dvec3 eye = MeasuredScan::kCorner + from;
    int front = 0, behind = 0;
    for (int y = 2; y < 300; y += 5)
        for (int x = 2; x < 400; x += 5) {
            const auto picked = pick_point(*picture, {x / 400.0, y / 300.0}, cache_);
            ASSERT_TRUE(picked);
            if (!*picked) continue;
            const glm::dvec3 p = (*picked)->point.position;
            if (p.y - MeasuredScan::kCorner.y < 1) {
                ++front;
                continue;
            }
            ++behind;
            // Where the line of sight crosses the front wall, there must be the window or the wall's end.
            const glm::dvec3 q = eye + (p - eye) * ((MeasuredScan::kCorner.y - eye.y) / (p.y - eye.y));
            const glm::dvec3 at = q - MeasuredScan::kCorner;
            const bool in_window = at.x > 1.45 && at.x < 2.55 && at.z > 0.95 && at.z < 2.05;
            const bool beside = at.x < 0 || at.x > 4 || at.z < 0 || at.z > 3;
            EXPECT_TRUE(in_window || beside) << at.x << " " << at.z;
        }
    EXPECT_GT(front, 500);
    EXPECT_GT(behind, 200);
}

/// A wall (x 0 to 4, z 0 to 3, y = 0) as a rough scan has it: few points, half a spacing of noise across it.
std::shared_ptr<const octree::NodeSource> rough_wall(const std::filesystem::path& file) {
    io::Schema schema;
    schema.position = io::PositionType::f64;
    schema.stride = 24;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> along(0, 4), up(0, 3);
    std::normal_distribution<double> across(0, 0.05);
    std::vector<glm::dvec3> points(1200);
    for (glm::dvec3& point : points) {
        point.x = along(random);
        point.y = across(random);
        point.z = up(random);
    }
    const test::ComputedSource scan(schema, points.size(),
                                    [&](uint64_t i, std::byte* record) { io::store(record, points[i]); });
    octree::BuildOptions options;
    options.inputs = {&scan};
    options.output = file;
    const auto built = octree::build_cache(options);
    EXPECT_TRUE(built) << built.error().line();
    auto opened = octree::open_cache(file);
    return opened ? std::move(*opened) : nullptr;
}

// Few points have large discs that are tilted and cover each other's centres.
TEST_F(Pick, TakesAPointOfARoughSurfaceNearlyWhereverItIsSeen) {
    const test::TempFolder folder;
    const auto wall = rough_wall(folder / "rough.luc");
    ASSERT_TRUE(wall);
    const auto picture = look_at(wall, {-1, -1, 1.5}, {2, 0, 1.5});
    ASSERT_TRUE(picture);
    NodeCache cache(wall);
    int seen = 0, without = 0;
    for (int y = 0; y < 300; y += 4)
        for (int x = 0; x < 400; x += 4) {
            if (!(picture->depth[static_cast<size_t>(y) * 400 + static_cast<size_t>(x)] > 0)) continue;
            ++seen;
            const auto picked = pick_point(*picture, {(x + 0.5) / 400, (y + 0.5) / 300}, cache);
            ASSERT_TRUE(picked);
            if (!*picked)
                ++without;
            else
                EXPECT_LT(glm::distance((*picked)->point.position, picture->seen_at({x, y})), 1)
                    << "no disc is larger";
        }
    EXPECT_GT(seen, 1000);
    EXPECT_LE(without, seen / 200);
}

TEST_F(Pick, NeverTakesAPointThatIsClippedOrOfAHiddenClass) {
    gi::Look clipped, hidden_class;
    clipped.clip.planes.push_back({MeasuredScan::kCorner + glm::dvec3(0, 1, 0), {0, 1, 0}});
    hidden_class.hidden_classes.set(6);  // the front wall's
    for (const gi::Look& how : {clipped, hidden_class}) {
        const auto picture = look({2, -4, 1.5}, {2, 0, 1.5}, how);
        ASSERT_TRUE(picture);
        int picks = 0;
        for (int y = 2; y < 300; y += 9)
            for (int x = 2; x < 400; x += 9) {
                const auto picked = pick_point(*picture, {x / 400.0, y / 300.0}, cache_);
                ASSERT_TRUE(picked);
                if (!*picked) continue;
                ++picks;
                const ExactPoint& point = (*picked)->point;
                if (how.clip.active())
                    EXPECT_GT(point.position.y, MeasuredScan::kCorner.y + 1);
                else
                    EXPECT_EQ(field(point, "classification"), "2 Ground");
            }
        EXPECT_GT(picks, 300);
    }
}

TEST_F(Pick, WhatWasPickedStandsWithinHalfAPixelOfItsPlace) {
    const auto picture = look({1, -3, 2.5}, {2, 0, 1.5});
    ASSERT_TRUE(picture);
    int seen = 0;
    for (int y = 3; y < 300; y += 13)
        for (int x = 3; x < 400; x += 13) {
            const auto world = picture->pick({(x + 0.5) / 400, (y + 0.5) / 300});
            if (!world || !(picture->depth[static_cast<size_t>(y) * 400 + static_cast<size_t>(x)] > 0))
                continue;
            ++seen;
            const auto back = project(*picture, *world);
            ASSERT_TRUE(back);
            EXPECT_LE(std::abs(back->pixel.x - (x + 0.5)), 0.5);
            EXPECT_LE(std::abs(back->pixel.y - (y + 0.5)), 0.5);
        }
    EXPECT_GT(seen, 200);
}

TEST_F(Pick, LabelsStandAtTheirPointsAndWhatAWallHidesIsDimmed) {
    const auto picture = look({2, -4, 1.5}, {2, 0, 1.5});
    ASSERT_TRUE(picture);
    // From in front of the wall to behind it: one visible line and one hidden line.
    Measurement through;
    through.kind = MeasureKind::distance;
    through.points.resize(2);
    through.points[0].position = MeasuredScan::kCorner + glm::dvec3(0.5, -0.5, 0.5);
    through.points[1].position = MeasuredScan::kCorner + glm::dvec3(0.7, 1.5, 0.7);
    const glm::dvec2 window(800, 600);  // twice the picture's size
    const Overlay overlay = overlay_of({&through, 1}, *picture, window, {false, MeasuredScan::kFoot});
    ASSERT_EQ(overlay.marks.size(), 2u);
    EXPECT_FALSE(overlay.marks[0].hidden);
    EXPECT_TRUE(overlay.marks[1].hidden);
    EXPECT_LT(glm::distance(overlay.marks[0].at, 2.0 * project(*picture, through.points[0].position)->pixel),
              1e-6);
    ASSERT_EQ(overlay.lines.size(), 2u);
    EXPECT_FALSE(overlay.lines[0].hidden);
    EXPECT_TRUE(overlay.lines[1].hidden);
    EXPECT_EQ(overlay.lines[0].to, overlay.lines[1].from);
    // It crosses the wall after a quarter of its length.
    const auto at_wall = project(*picture, MeasuredScan::kCorner + glm::dvec3(0.55, 0, 0.55));
    EXPECT_LT(glm::distance(overlay.lines[0].to, 2.0 * at_wall->pixel), 8);
    ASSERT_EQ(overlay.labels.size(), 1u);
    EXPECT_EQ(overlay.labels[0].text, "2.0199 US ft") << "the file's own unit";
    through.points[0].position.y -= 100;  // behind the camera
    EXPECT_EQ(overlay_of({&through, 1}, *picture, window, {}).marks.size(), 1u);
}

TEST_F(Pick, WhereNothingIsSeenThereIsNoPoint) {
    const auto picture = look({2, -4, 1.5}, {2, -8, 1.5});  // away from the walls
    ASSERT_TRUE(picture);
    for (const glm::dvec2 place :
         {glm::dvec2(0.5, 0.5), glm::dvec2(0, 0), glm::dvec2(-1, 2), glm::dvec2(NAN, 0.5)}) {
        const auto picked = pick_point(*picture, place, cache_);
        ASSERT_TRUE(picked);
        EXPECT_FALSE(*picked);
    }
    EXPECT_FALSE(project(*picture, MeasuredScan::kCorner)) << "behind the camera";
}

}  // namespace
}  // namespace lucarne::viewer
