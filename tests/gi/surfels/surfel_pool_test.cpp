#include "gi/surfels/surfel_pool.h"

#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "octree/tree/attributes.h"
#include "octree/tree/footprint.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kPage = SurfelPool::kPageSurfels;

std::vector<PackedSurfel> filled(size_t count, uint32_t word) {
    return {count, PackedSurfel{word, word, word, word}};
}

class SurfelPoolTest : public OnDevice {
 protected:
    SurfelPool pool_of(uint32_t pages) {
        auto pool = SurfelPool::create(*device, pages * kPage);
        EXPECT_TRUE(pool);
        return std::move(*pool);
    }
};

std::vector<Surfel> random_surfels(size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Surfel> surfels;
    for (size_t i = 0; i < count; ++i) {
        const glm::vec3 p(unit(random) * 16 - 8, unit(random) * 16 - 8, unit(random) * 16 - 8);
        surfels.push_back({p, glm::normalize(p), glm::vec3(unit(random)), 0, 0.01f * unit(random), 7});
    }
    return surfels;
}

TEST_F(SurfelPoolTest, PoolTakesAllItsMemoryAtOnceAndKeepsToTheCap) {
    device->set_memory_cap(10 * kPage * sizeof(PackedSurfel));
    EXPECT_FALSE(SurfelPool::create(*device, 11 * kPage));
    const auto pool = SurfelPool::create(*device, 9 * kPage + 1);
    ASSERT_TRUE(pool);
    EXPECT_EQ(pool->capacity(), 10 * kPage);
    EXPECT_EQ(device->memory_used(), 10 * kPage * sizeof(PackedSurfel));
}

TEST_F(SurfelPoolTest, FullPoolRefusesUntilANodeIsEvicted) {
    SurfelPool pool = pool_of(4);
    EXPECT_TRUE(pool.load(0, filled(2 * kPage, 0)).value());
    EXPECT_TRUE(pool.load(1, filled(kPage + 1, 1)).value());
    EXPECT_EQ(pool.used(), 4 * kPage);
    EXPECT_FALSE(pool.load(2, filled(1, 2)).value());
    EXPECT_FALSE(pool.holds(2));
    pool.evict(0);
    EXPECT_FALSE(pool.holds(0));
    EXPECT_TRUE(pool.load(2, filled(1, 2)).value());
    EXPECT_TRUE(pool.holds(2));
}

TEST_F(SurfelPoolTest, EvictedNeighboursMakeRoomForALargerNode) {
    SurfelPool pool = pool_of(6);
    for (uint32_t node = 0; node < 6; ++node) ASSERT_TRUE(pool.load(node, filled(kPage, node)).value());
    for (const uint32_t node : {2u, 4u, 3u}) pool.evict(node);
    EXPECT_TRUE(pool.load(9, filled(3 * kPage, 9)).value());
    EXPECT_EQ(pool.used(), 6 * kPage);
}

TEST_F(SurfelPoolTest, ScatteredFreePagesHoldALargeNodeAndNothingIsLost) {
    // Evicts single-page nodes that lie between others, so that free pages are scattered. The other nodes
    // must not change when a large node takes those pages.
    std::vector<Surfel> surfels = random_surfels(40000, 3);
    const SurfelCloud cloud(surfels);
    const uint32_t pages = cloud.pages(), others = 8;
    SurfelPool pool = pool_of(pages + 2 * others);
    uint32_t stranger = 1'000'000;
    for (uint32_t i = 0; i < others; ++i) ASSERT_TRUE(pool.load(stranger++, filled(kPage, i)).value());
    for (uint32_t node = 0; node < cloud.nodes().size(); ++node) {
        ASSERT_TRUE(pool.load(node, cloud.packed(node)).value());
        if (node >= others) continue;
        ASSERT_TRUE(pool.load(stranger++, filled(kPage, node)).value());
    }
    for (uint32_t node = 1'000'000; node < stranger; ++node) pool.evict(node);
    DeviceCut cut;
    ASSERT_TRUE(pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0.0), cut));
    const auto before = pool.download(cut);
    EXPECT_TRUE(pool.load(2'000'000, filled(2 * others * kPage, 1)).value());
    ASSERT_TRUE(pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0.0), cut));
    const auto after = pool.download(cut);
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); ++i) ASSERT_EQ(after[i].position, before[i].position) << i;
    EXPECT_FALSE(pool.load(3'000'000, filled(1, 1)).value()) << "not a page is left";
}

TEST_F(SurfelPoolTest, ManyLoadsAndEvictionsLoseNoPages) {
    SurfelPool pool = pool_of(32);
    std::mt19937 random(1);
    std::map<uint32_t, uint32_t> held;  // node -> pages
    for (int step = 0; step < 2000; ++step) {
        const uint32_t node = random() % 20;
        if (random() % 2) {
            pool.evict(node);
            held.erase(node);
        } else {
            const uint32_t surfels = random() % (5 * kPage);
            held.erase(node);  // a node that is resident is replaced
            if (pool.load(node, filled(surfels, node)).value()) held[node] = (surfels + kPage - 1) / kPage;
        }
        uint32_t pages = 0;
        for (const auto& [other, count] : held) {
            pages += count;
            ASSERT_TRUE(pool.holds(other));
        }
        ASSERT_EQ(pool.used(), pages * kPage);
    }
    for (uint32_t node = 0; node < 20; ++node) pool.evict(node);
    EXPECT_TRUE(pool.load(0, filled(32 * kPage, 0)).value()) << "all pages are free again";
}

TEST_F(SurfelPoolTest, SurfelsComeBackAsTheyWent) {
    const auto surfels = random_surfels(20000, 1);
    const SurfelCloud cloud(surfels);
    auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    auto back = (*loaded)->pool.download((*loaded)->cut);
    ASSERT_EQ(back.size(), surfels.size());
    const auto by_place = [](const Surfel& a, const Surfel& b) { return a.position.x < b.position.x; };
    auto sent = surfels;
    std::sort(sent.begin(), sent.end(), by_place);
    std::sort(back.begin(), back.end(), by_place);
    size_t matched = 0;
    for (size_t i = 0; i < sent.size(); ++i) {
        if (glm::length(sent[i].position - back[i].position) > 1e-3f) continue;  // two in the same place
        ++matched;
        EXPECT_GT(glm::dot(sent[i].normal, back[i].normal), 0.99999f);
        EXPECT_NEAR(sent[i].albedo.y, back[i].albedo.y, 2e-3f);
        EXPECT_EQ(back[i].material, 7u);
        EXPECT_GE(back[i].area, sent[i].area * 0.95f) << "the floor only raises";
        EXPECT_GT(back[i].radius, 0.0f);
    }
    EXPECT_GT(matched, sent.size() * 9 / 10);
}

TEST_F(SurfelPoolTest, AncestorsTakeTheFloorOfTheDeepestNodeAround) {
    // Dense in one octant only: there the root's surfels are small, elsewhere they keep the floor of the
    // root.
    std::vector<Surfel> surfels;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 4000; ++i) {
        const float scale = i % 2 ? 7.9f : -7.9f;
        surfels.push_back({glm::vec3(unit(random), unit(random), unit(random)) * scale,
                           {0, 0, 1},
                           glm::vec3(0.5f),
                           0,
                           i % 2 ? 1e-4f : 1e-2f,
                           0});
    }
    const SurfelCloud cloud(surfels, {{-8, -8, -8}, 16}, 512, 4.0f);
    auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    ASSERT_GT(cloud.nodes().size(), 2u);
    const auto back = (*loaded)->pool.download((*loaded)->cut);
    for (size_t i = 0; i < 512; ++i) {  // the root's own surfels come first
        const float share = back[i].position.x > 0 ? 1e-4f : 1e-2f;
        EXPECT_NEAR(back[i].area, 4 * share, share * 0.01f) << back[i].position.x;
        EXPECT_NEAR(back[i].radius, octree::surfel_radius(share, 4 * share), back[i].radius * 0.03f);
    }
}

TEST_F(SurfelPoolTest, ShorterPrefixHasALargerFloor) {
    const SurfelCloud cloud(random_surfels(1000, 1));
    auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    DeviceCut quarter;
    const std::vector<CutEntry> entries = {{0, 250}};
    ASSERT_TRUE((*loaded)->pool.make_cut(*device, cloud, entries, glm::dvec3(0), quarter));
    EXPECT_EQ(quarter.surfels(), 250u);
    for (const Surfel& s : (*loaded)->pool.download(quarter))
        EXPECT_GE(s.area, cloud.nodes()[0].area_floor[2] * 0.999f);
}

TEST_F(SurfelPoolTest, OnePointOfANodeLeavesItsAncestorsAsLargeAsTheyWere) {
    const SurfelCloud cloud(random_surfels(40'000, 5), {{-8, -8, -8}, 16}, 256);
    const auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    const SurfelPool& pool = (*loaded)->pool;
    std::vector<CutEntry> entries = {{0, cloud.nodes()[0].count}};
    const auto largest = [&] {
        DeviceCut cut;
        EXPECT_TRUE(pool.make_cut(*device, cloud, entries, glm::dvec3(0.0), cut));
        float radius = 0;
        for (const Surfel& s : pool.download(cut)) radius = std::max(radius, s.radius);
        return radius;
    };
    const float root_alone = largest();
    ASSERT_NE(cloud.nodes()[0].child_mask, 0);
    entries.push_back({cloud.nodes()[0].first_child, 1});
    EXPECT_LE(largest(), root_alone * 1.001f);
}

TEST_F(SurfelPoolTest, CutLeavesOutWhatIsNotResidentWithItsDescendants) {
    const SurfelCloud cloud(random_surfels(40000, 1), {{-8, -8, -8}, 16}, 256);
    auto loaded = load_cloud(*device, cloud);
    ASSERT_TRUE(loaded);
    uint32_t inner = 1;
    while (!cloud.nodes()[inner].child_mask) ++inner;
    (*loaded)->pool.evict(inner);
    uint32_t expected = 0;
    std::set<uint32_t> missing = {inner};
    for (uint32_t node = 0; node < cloud.nodes().size(); ++node) {
        if (missing.contains(cloud.nodes()[node].parent)) missing.insert(node);
        if (!missing.contains(node)) expected += cloud.nodes()[node].count;
    }
    EXPECT_GT(missing.size(), 1u);
    DeviceCut cut;
    ASSERT_TRUE((*loaded)->pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0), cut));
    EXPECT_EQ(cut.surfels(), expected);
}

TEST_F(SurfelPoolTest, IdsDoNotDependOnWhatElseIsResidentOrOnTheOrderOfTheEntries) {
    const SurfelCloud cloud(random_surfels(20000, 1), {{-8, -8, -8}, 16}, 256);
    auto first = load_cloud(*device, cloud);
    ASSERT_TRUE(first);
    SurfelPool other = pool_of(cloud.pages() + 8);
    ASSERT_TRUE(other.load(1u << 20, filled(3 * kPage, 1)).value());
    auto entries = cloud.whole();
    std::reverse(entries.begin(), entries.end());
    for (const CutEntry& entry : entries)
        ASSERT_TRUE(other.load(entry.node, cloud.packed(entry.node)).value());
    entries.push_back(entries[3]);  // a repeated entry counts once
    DeviceCut cut;
    ASSERT_TRUE(other.make_cut(*device, cloud, entries, glm::dvec3(0), cut));
    const auto a = (*first)->pool.download((*first)->cut), b = other.download(cut);
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].position, b[i].position) << i;
    EXPECT_EQ(cut.blocks(), (*first)->cut.blocks());
}

TEST_F(SurfelPoolTest, HostileFloorsAndEntriesAreBounded) {
    class Hostile : public octree::NodeSource {
     public:
        Hostile() {
            header_.root = {{0, 0, 0}, 1};
            const float none = std::numeric_limits<float>::quiet_NaN(),
                        much = std::numeric_limits<float>::infinity();
            octree::NodeInfo node;
            node.count = 100;
            for (const float floor : {none, much, -1.0f, 1e30f}) {
                node.area_floor = {floor, floor, floor, floor};
                node.parent = nodes_.empty() ? octree::kNoNode : 0;
                node.key = nodes_.empty() ? octree::NodeKey{} : octree::NodeKey{1, 0, 0, 0};
                nodes_.push_back(node);
            }
        }
        const octree::SourceHeader& header() const override { return header_; }
        octree::NodeTable nodes() const override { return nodes_; }
        Result<octree::NodeData> load(uint32_t) const override { return failed("hostile", "has no points"); }

     private:
        octree::SourceHeader header_;
        std::vector<octree::NodeInfo> nodes_;
    } source;
    SurfelPool pool = pool_of(8);
    for (uint32_t node = 0; node < 4; ++node) ASSERT_TRUE(pool.load(node, filled(100, 0xff0000u)).value());
    const std::vector<CutEntry> entries = {{0, 4000000000u}, {1, 100}, {2, 100}, {3, 100}, {77, 5}};
    DeviceCut cut;
    ASSERT_TRUE(pool.make_cut(*device, source, entries, glm::dvec3(0), cut));
    EXPECT_EQ(cut.surfels(), 400u);
    for (const Surfel& s : pool.download(cut)) {
        EXPECT_TRUE(std::isfinite(s.radius));
        EXPECT_LE(s.area * 100, 64.0f) << "no node holds many times the surface of its cube";
    }
}

/// One record with every attribute of a scan.
struct Records {
    octree::SourceHeader header;
    octree::NodeData data;

    explicit Records(io::ScalarType color = io::ScalarType::u16) {
        header.root = {{100, 200, 300}, 16};
        header.schema.position = io::PositionType::f64;
        header.schema.add("color", color, 3);
        header.schema.add("normal_oct", io::ScalarType::u8, 3);
        header.schema.add("area", io::ScalarType::u16);
        header.schema.add("classification", io::ScalarType::u8);
        header.schema.add("scan", io::ScalarType::u16);
        header.scans.resize(2);
        for (auto& scan : header.scans) scan.color_bits = color == io::ScalarType::f32 ? 0 : 16;
    }
    std::byte* add(const glm::dvec3& at, const glm::dvec3& color, octree::NormalCode normal, double area,
                   int cls, int scan) {
        const size_t start = data.records.size();
        data.records.resize(start + header.schema.stride);
        std::byte* record = data.records.data() + start;
        for (int i = 0; i < 3; ++i) {
            io::store(record + 8 * i, at[i]);
            const auto* c = header.schema.find("color");
            io::store_scalar(c->type, record + c->offset + io::scalar_bytes(c->type) * i, color[i]);
            io::store(record + header.schema.find("normal_oct")->offset + i, normal[static_cast<size_t>(i)]);
        }
        io::store(record + header.schema.find("area")->offset, octree::encode_area(area, header.root.size));
        io::store(record + header.schema.find("classification")->offset, static_cast<uint8_t>(cls));
        io::store(record + header.schema.find("scan")->offset, static_cast<uint16_t>(scan));
        ++data.count;
        return record;
    }
    std::vector<PackedSurfel> pack(const Scene& scene, const octree::NodeKey& key = {}) const {
        octree::NodeInfo node;
        node.key = key;
        node.count = data.count;
        return pack_surfels(header, node, data, scene);
    }
};

Scene one_material() {
    Scene scene;
    scene.materials.resize(1);
    return scene;
}

TEST(PackSurfels, TheFilesOwnNormalsAreDrawnUnlessEstimatedOnesReplaceThem) {
    const glm::vec3 own(1, 0, 0), estimated(0, 0, 1);
    for (const std::string name : {"normal", "normal_in_file"}) {
        Records records;
        records.header.schema.add(name, io::ScalarType::f32, 3);
        std::byte* record =
            records.add({105, 210, 315}, {1, 1, 1}, octree::encode_normal(estimated), 0.02, 2, 0);
        io::store(record + records.header.schema.find(name)->offset, own);
        const auto surfels = records.pack(one_material());
        ASSERT_EQ(surfels.size(), 1u);
        const glm::vec3 expected = name == "normal" ? own : estimated;
        EXPECT_GT(glm::dot(decode_octahedral(surfels[0].c), expected), 0.999f) << name;
    }
}

TEST(PackSurfels, RecordsKeepPlaceColourNormalAndArea) {
    Records records;
    const glm::vec3 normal = glm::normalize(glm::vec3(1, -2, 3));
    const octree::NodeKey key{2, 1, 2, 3};  // 4 m from (104, 208, 312)
    records.add({105, 210, 315}, {65535, 32768, 0}, octree::encode_normal(normal), 0.02, 2, 0);
    const auto packed = records.pack(one_material(), key);
    ASSERT_EQ(packed.size(), 1u);
    const glm::vec3 at = surfel_fractions(packed[0].a, packed[0].b);
    EXPECT_NEAR(at.x, 0.25, 1e-4);
    EXPECT_NEAR(at.y, 0.5, 1e-4);
    EXPECT_NEAR(at.z, 0.75, 1e-4);
    EXPECT_NEAR(surfel_own_area(packed[0].b, 4), 0.02, 0.02 * 0.045);
    EXPECT_TRUE(packed[0].d & kSurfelHasNormal);
    EXPECT_GT(glm::dot(decode_octahedral(packed[0].c), normal), 0.99999f);
    const glm::vec3 albedo = decode_albedo(packed[0].d);
    EXPECT_FLOAT_EQ(albedo.x, 1.0f);
    EXPECT_NEAR(albedo.y, srgb_to_linear(0.5f), 1e-3f);
    EXPECT_EQ(albedo.z, 0.0f);
}

TEST(PackSurfels, UnknownNormalAndAreaAreMarked) {
    Records records;
    records.add({101, 201, 301}, {0, 0, 0}, octree::kNoNormal, 0, 0, 0);
    const auto packed = records.pack(one_material());
    EXPECT_FALSE(packed[0].d & kSurfelHasNormal);
    EXPECT_EQ(surfel_own_area(packed[0].b, 16), 0.0f);
}

TEST(PackSurfels, OutliersAreDrawnAtStrictnessZeroAloneAndHiddenClassesNever) {
    Records records;
    records.add({101, 201, 301}, {0, 0, 0}, octree::encode_normal({0, 0, 1}), 0.01, 0, 0);
    for (const int cls : {0, 7}) records.add({104, 201, 301}, {0, 0, 0}, octree::kNoNormal, 1e-30, cls, 0);
    Scene scene = one_material();
    scene.look.hidden_classes.set(7);
    const auto usual = records.pack(scene);
    EXPECT_FALSE(surfel_is_stray(usual[0].b, usual[0].d));
    EXPECT_TRUE(surfel_is_stray(usual[1].b, usual[1].d));
    scene.look.outliers = 0;
    const auto all = records.pack(scene);
    EXPECT_EQ(surfel_own_area(all[1].b, 16), surfel_own_area(all[0].b, 16));
    EXPECT_TRUE(surfel_is_stray(all[2].b, all[2].d));
}

TEST(PackSurfels, FilesOwnNormalComesFirstAndNoNumberIsNoNormal) {
    Records records;
    records.header.schema.add("normal", io::ScalarType::f32, 3);
    const glm::vec3 estimated(0, 0, 1);
    const float none = std::numeric_limits<float>::quiet_NaN();
    for (const glm::vec3 own : {glm::vec3(0, -3, 0), glm::vec3(0.0f), glm::vec3(none, 0, 1)}) {
        std::byte* record =
            records.add({101, 201, 301}, {0, 0, 0}, octree::encode_normal(estimated), 0, 0, 0);
        for (int i = 0; i < 3; ++i)
            io::store(record + records.header.schema.find("normal")->offset + 4 * i, own[i]);
    }
    const auto packed = records.pack(one_material());
    EXPECT_LT(decode_octahedral(packed[0].c).y, -0.9999f);
    EXPECT_GT(decode_octahedral(packed[1].c).z, 0.9999f);
    EXPECT_GT(decode_octahedral(packed[2].c).z, 0.9999f);
}

TEST(PackSurfels, ScanWithoutColourIsMidGrey) {
    Records records;
    records.add({101, 201, 301}, {65535, 0, 0}, octree::kNoNormal, 0, 0, 0);
    records.header.schema.attributes[0].name = "rgb";
    EXPECT_NEAR(decode_albedo(records.pack(one_material())[0].d).y, 0.5f, 1e-3f);
}

TEST(PackSurfels, ColourFieldsNeverFilledAreNoColour) {
    Records records;
    records.add({101, 201, 301}, {0, 0, 0}, octree::kNoNormal, 0, 0, 0);
    records.add({102, 202, 302}, {0, 0, 0}, octree::kNoNormal, 0, 0, 0);
    EXPECT_NEAR(decode_albedo(records.pack(one_material())[1].d).y, 0.5f, 1e-3f);
    records.add({103, 203, 303}, {0, 300, 0}, octree::kNoNormal, 0, 0, 0);  // one colour: black is black
    EXPECT_EQ(decode_albedo(records.pack(one_material())[1].d).y, 0.0f);
}

TEST(PackSurfels, EachScansOwnWhiteCounts) {
    Records records;
    records.header.scans[1].color_bits = 8;  // 8-bit values in 16-bit fields
    records.add({101, 201, 301}, {65535, 257, 0}, octree::kNoNormal, 0, 0, 0);
    records.add({101, 201, 301}, {255, 1, 0}, octree::kNoNormal, 0, 0, 1);
    const auto packed = records.pack(one_material());
    EXPECT_EQ(packed[0].d, packed[1].d);
    EXPECT_EQ(decode_albedo(packed[1].d).x, 1.0f);
}

TEST(PackSurfels, AreasThatNoNodeCanHoldAreShrunk) {
    Records records;
    for (int i = 0; i < 1000; ++i) records.add({101, 201, 301}, {0, 0, 0}, octree::kNoNormal, 256, 0, 0);
    double sum = 0;
    for (const PackedSurfel& s : records.pack(one_material())) sum += surfel_own_area(s.b, 16);
    EXPECT_LE(sum, kMostSurface * 256 * 1.001);
    EXPECT_GT(sum, kMostSurface * 256 * 0.9);
}

TEST(PackSurfels, ColourOutsideItsRangeIsClamped) {
    Records records(io::ScalarType::f32);
    const double none = std::numeric_limits<double>::quiet_NaN();
    records.add({101, 201, 301}, {7, -3, none}, octree::kNoNormal, 0, 0, 0);
    EXPECT_EQ(decode_albedo(records.pack(one_material())[0].d), glm::vec3(1, 0, 0));
}

TEST(PackSurfels, LastMaterialWhoseConditionsHoldIsAssigned) {
    Scene scene;
    scene.materials.resize(4);
    scene.materials[1].classification = 6;
    scene.materials[2].scan = 1;
    scene.materials[3].box = {{101, 201, 301}, {102, 202, 302}};
    scene.materials[3].classification = 6;
    Records records;
    const glm::dvec3 inside(101.5, 201.5, 301.5), outside(105, 205, 305);
    records.add(outside, {0, 0, 0}, octree::kNoNormal, 0, 2, 0);
    records.add(outside, {0, 0, 0}, octree::kNoNormal, 0, 6, 0);
    records.add(outside, {0, 0, 0}, octree::kNoNormal, 0, 6, 1);
    records.add(inside, {0, 0, 0}, octree::kNoNormal, 0, 2, 0);
    records.add(inside, {0, 0, 0}, octree::kNoNormal, 0, 6, 1);
    const auto packed = records.pack(scene);
    for (const auto& [at, material] : {std::pair{0, 0u}, {1, 1u}, {2, 2u}, {3, 0u}, {4, 3u}})
        EXPECT_EQ(surfel_material(packed[static_cast<size_t>(at)].b), material) << at;
}

TEST(PackSurfels, PointsOutsideTheirNodeAndMissingBytesAreHarmless) {
    Records records;
    records.add({-1e300, 1e300, std::numeric_limits<double>::quiet_NaN()}, {0, 0, 0}, octree::kNoNormal, 0, 0,
                0);
    records.data.count = 1000;  // claims more points than there are
    const auto packed = records.pack(one_material());
    ASSERT_EQ(packed.size(), 1u);
    EXPECT_EQ(packed[0].a, 0xffff0000u);
}

TEST(SurfelCode, SharedFunctionsInvertEachOther) {
    std::mt19937 random(1);
    std::normal_distribution<float> gauss(0, 1);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
        EXPECT_GT(glm::dot(decode_octahedral(encode_octahedral(n)), n), 1 - 1e-6f);
    }
    for (int i = 0; i < 1024; ++i) {
        const float v = static_cast<float>(i) / 1023;
        EXPECT_NEAR(linear_to_srgb(srgb_to_linear(v)), v, 1e-5f);
    }
}

}  // namespace
}  // namespace lucarne::gi
