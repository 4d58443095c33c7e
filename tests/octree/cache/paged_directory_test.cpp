// Directories that are read page by page, as those of very large caches are.
#include "octree/cache/paged_directory.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/file.h"
#include "octree/cache/writer.h"
#include "octree/convert/build.h"
#include "octree/stream/cut.h"
#include "octree/stream/joined_source.h"
#include "tests/octree/cache/large_cache.h"
#include "tests/octree/cache/paged_cache.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kPageNodes = 16;

bool operator==(const NodeInfo& a, const NodeInfo& b) {
    return a.key == b.key && a.parent == b.parent && a.first_child == b.first_child &&
           a.child_mask == b.child_mask && a.count == b.count && a.subtree_count == b.subtree_count &&
           a.payload_bytes == b.payload_bytes && a.area_floor == b.area_floor;
}

/// An uneven tree of some thousand nodes with few points each.
class PagedCache : public testing::Test {
 protected:
    void SetUp() override {
        header_.schema.position = io::PositionType::f32;
        header_.schema.stride = 12;
        header_.root = {glm::dvec3(0), 1.0};
        header_.min = glm::dvec3(1);
        auto writer = CacheWriter::create(path(), false, folder_.path()).value();
        header_.points = add(writer, {}, 5).subtree_count;
        ASSERT_TRUE(writer.finish(header_, {kPageNodes, 1}));
        whole_ = CacheFile::open(path(), kWholeDirectory).value();
        ASSERT_GT(whole_->nodes().size(), 3000u);
        ASSERT_LT(whole_->nodes().size(), 12'000u);
    }

    std::filesystem::path path() const { return folder_ / "paged.luc"; }

    /// Writes a subtree, its root last.
    format::Entry add(CacheWriter& writer, const NodeKey& key, uint32_t levels) {
        format::Entry entry{.key = key};
        std::vector<format::Entry> children;
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (levels == 0 || random_.uniform() > (key.level < 2 ? .9 : .6)) continue;
            // Other subtrees come between siblings in the file; the directory has them side by side.
            children.push_back(add(writer, key.child(octant), levels - 1));
            entry.child_mask |= 1 << octant;
            entry.subtree_count += children.back().subtree_count;
        }
        entry.count = 1 + static_cast<uint32_t>(5 * random_.uniform());
        entry.subtree_count += entry.count;
        std::vector<std::byte> records(12 * size_t{entry.count});
        const Cube cube = header_.root.of(key);
        for (uint32_t i = 0; i < 3 * entry.count; ++i) {
            const int axis = static_cast<int>(i % 3);
            const auto at = static_cast<float>(cube.min[axis] + cube.size * (.1 + .8 * random_.uniform()));
            io::store(&records[4 * size_t{i}], at);
            header_.min[axis] = std::min(header_.min[axis], double{at});
            header_.max[axis] = std::max(header_.max[axis], double{at});
        }
        entry.payload_bytes = static_cast<uint32_t>(records.size());
        entry.payload_offset = writer.append(records).value();
        entry.checksum = format::checksum(records);
        entry.area_floor.fill(static_cast<float>(cube.size * cube.size / 5));
        EXPECT_TRUE(writer.add(entry));
        return entry;
    }

    std::string bytes() const {
        std::ifstream in(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::filesystem::path write(const std::string& bytes) const {
        const auto name = folder_ / "damaged.luc";
        std::ofstream(name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return name;
    }
    /// Returns the file with one entry of the directory changed, and the checksum of its page as in a forged
    /// file.
    std::filesystem::path with_entry(uint32_t node, const std::function<void(format::Entry&)>& change) const {
        std::string all = bytes();
        auto* const file = reinterpret_cast<std::byte*>(all.data());
        format::Superblock block = whole_->superblock();
        std::byte* at = file + block.directory_offset + uint64_t{node} * format::kEntryBytes;
        format::Entry entry = format::load_entry(at);
        change(entry);
        format::store_entry(entry, at);
        const DirectoryPages pages = *whole_->header().directory_pages;
        const uint32_t page = node / kPageNodes;
        const uint64_t first = uint64_t{page} * kPageNodes * format::kEntryBytes;
        const auto in_page =
            std::span(file + block.directory_offset + first,
                      std::min<uint64_t>(kPageNodes * format::kEntryBytes, block.directory_bytes - first));
        io::store(file + pages.offset + page * format::kPageBytes, format::checksum(in_page));
        return forged(std::move(all));
    }
    /// Writes the file with the checksum of its list of pages as in a forged file.
    std::filesystem::path forged(std::string all) const {
        const DirectoryPages pages = *whole_->header().directory_pages;
        const format::Superblock& before = whole_->superblock();
        auto* const file = reinterpret_cast<std::byte*>(all.data());
        const uint64_t sum = format::checksum(
            {file + pages.offset, pages_bytes(before.directory_bytes / format::kEntryBytes, kPageNodes)});
        return with_metadata(std::move(all), fmt::format("{}", pages.checksum), fmt::format("{}", sum));
    }
    /// Writes the file with another text in its metadata, which are moved behind its end.
    std::filesystem::path with_metadata(std::string all, const std::string& from,
                                        const std::string& to) const {
        format::Superblock block = whole_->superblock();
        std::string text = all.substr(block.metadata_offset, block.metadata_bytes);
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        if (sealed_)
            block.directory_checksum = format::checksum(
                std::as_bytes(std::span(all)).subspan(block.directory_offset, block.directory_bytes));
        block.metadata_offset = all.size();
        block.metadata_bytes = text.size();
        block.metadata_checksum = format::checksum(std::as_bytes(std::span(text)));
        all += text;
        block.file_bytes = all.size();
        const auto encoded = format::encode(block);
        std::memcpy(all.data(), encoded.data(), encoded.size());
        std::memcpy(all.data() + encoded.size(), encoded.data(), encoded.size());
        return write(all);
    }

    const lucarne::test::TempFolder folder_;
    Random random_{3, 7};
    bool sealed_ = false;  ///< forged files have the directory's checksum right as well
    SourceHeader header_;
    std::unique_ptr<CacheFile> whole_;
};

TEST_F(PagedCache, HasTheNodesOfAWholeDirectoryInAnyOrderWithFewPagesInMemory) {
    const auto paged = CacheFile::open(path(), 0).value();
    const NodeTable nodes = paged->nodes(), expected = whole_->nodes();
    ASSERT_EQ(nodes.size(), expected.size());
    const uint64_t page_bytes = kPageNodes * kNodeBytes;
    const uint64_t list = (nodes.size() / kPageNodes + 1) * sizeof(format::Page);
    EXPECT_LE(paged->directory_bytes(), PagedDirectory::kLeastPages * page_bytes + list);
    EXPECT_LT(paged->directory_bytes(), whole_->directory_bytes() / 4);
    for (uint32_t i = 0; i < nodes.size(); ++i) ASSERT_TRUE(nodes[i] == expected[i]) << i;
    for (uint32_t i = nodes.size(); i-- > 0;) ASSERT_TRUE(nodes[i] == expected[i]) << i;
    for (int n = 0; n < 5000; ++n) {
        const auto i = static_cast<uint32_t>(random_.uniform() * static_cast<double>(nodes.size()));
        ASSERT_TRUE(nodes[i] == expected[i]) << i;
        if (n % 50 == 0) {
            ASSERT_EQ(paged->load(i).value().records, whole_->load(i).value().records) << i;
        }
    }
    EXPECT_TRUE(paged->directory_state());
}

TEST_F(PagedCache, HoldsNoMorePagesThanItsMemoryAllows) {
    const PayloadReader reader = PayloadReader::create("test", whole_->header()).value();
    for (const uint64_t memory : {uint64_t{0}, uint64_t{100'000}}) {
        const auto directory =
            PagedDirectory::open(whole_->file(), whole_->superblock(), whole_->header(), reader, memory);
        ASSERT_TRUE(directory);
        EXPECT_EQ((*directory)->held(), 1u) << "the root's page alone: nothing else was looked at";
        for (uint32_t i = 0; i < whole_->nodes().size(); i += 7) (void)(*directory)->node(i);
        const uint64_t most = std::max(PagedDirectory::kLeastPages, memory / (kPageNodes * kNodeBytes));
        EXPECT_EQ((*directory)->held(), most);
    }
}

TEST_F(PagedCache, GivesTheSameCutsAndJoins) {
    std::shared_ptr<const NodeSource> paged = CacheFile::open(path(), 0).value();
    const auto same = [](const Cut& a, const Cut& b) {
        return std::ranges::equal(a.nodes, b.nodes, [](const CutNode& x, const CutNode& y) {
            return x.node == y.node && x.count == y.count && x.priority == y.priority;
        });
    };
    View view;
    view.position = {.5, -1, .5};
    view.width = view.height = 64;
    for (const uint64_t budget : {100, 1000, 100'000}) {
        EXPECT_TRUE(same(view_cut(*paged, view, budget), view_cut(*whole_, view, budget)));
        EXPECT_TRUE(same(light_cut(*paged, {.2, .3, .4}, budget), light_cut(*whole_, {.2, .3, .4}, budget)));
    }
    const auto joined = join_sources({paged, paged}).value();
    EXPECT_EQ(joined->nodes().size(), 2 * whole_->nodes().size());
    EXPECT_EQ(full_cut(*joined).points, 2 * whole_->header().points);
    EXPECT_LT(joined->directory_bytes(), whole_->directory_bytes()) << "they are not copied";
}

TEST_F(PagedCache, IsVerifiedPageByPage) {
    const auto verified = [&](const std::filesystem::path& file) {
        return verify_cache(
            InputFile::open_shared(file).value(), [](uint64_t) {}, 0);
    };
    const auto sound = verified(path());
    ASSERT_TRUE(sound) << sound.error().line();
    EXPECT_EQ(sound->points, header_.points);
    EXPECT_EQ(sound->nodes, whole_->nodes().size());
    const auto says = [&](const std::filesystem::path& file, const char* what) {
        const auto report = verified(file);
        ASSERT_FALSE(report) << what;
        EXPECT_NE(report.error().line().find(what), std::string::npos) << report.error().line();
    };
    const uint32_t node = static_cast<uint32_t>(whole_->nodes().size()) / 2;
    says(with_entry(node, [](auto& entry) { entry.area_floor[0] *= 2; }),
         "its directory does not match its checksum");
    sealed_ = true;
    says(with_entry(node, [](auto& entry) { entry.subtree_count += 1; }), "do not add up");
    const uint64_t other = whole_->entry(node - 1).payload_offset;
    says(with_entry(node, [&](auto& entry) { entry.payload_offset = other; }), "parts of it overlap");
}

TEST_F(PagedCache, ServesManyThreads) {
    const auto paged = CacheFile::open(path(), 0).value();
    const NodeTable expected = whole_->nodes();
    std::atomic<int> wrong = 0;
    std::vector<std::thread> threads;
    for (uint64_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            Random random(t, 5);
            for (int n = 0; n < 3000; ++n) {
                const auto i = static_cast<uint32_t>(random.uniform() * static_cast<double>(expected.size()));
                wrong += !(paged->nodes()[i] == expected[i]);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

TEST_F(PagedCache, ADamagedPageHidesItsNodesAloneAndIsReported) {
    const format::Superblock& block = whole_->superblock();
    const uint32_t node = 40 * kPageNodes + 3;
    std::string all = bytes();
    all[block.directory_offset + uint64_t{node} * format::kEntryBytes + 60] ^= 1;
    const auto paged = CacheFile::open(write(all), 0).value();
    EXPECT_TRUE(paged->directory_state()) << "nobody looked there yet";
    uint32_t missing = 0;
    for (uint32_t i = 0; i < paged->nodes().size(); ++i) {
        const NodeInfo info = paged->nodes()[i];
        // Parents in the page are needed to find those of its children, so these are missing as well.
        if (info == whole_->nodes()[i]) continue;
        ++missing;
        EXPECT_EQ(info.count, 0u);
        EXPECT_EQ(info.child_mask, 0u);
    }
    EXPECT_GE(missing, kPageNodes);
    EXPECT_LE(missing, 12 * kPageNodes);
    ASSERT_FALSE(paged->directory_state());
    EXPECT_NE(paged->directory_state().error().line().find("page 40 of its directory"), std::string::npos);
    EXPECT_FALSE(paged->load(node));
    EXPECT_FALSE(CacheFile::open(write(all), kWholeDirectory));
}

TEST_F(PagedCache, EveryFlippedByteOfTheListOfPagesIsFound) {
    const DirectoryPages pages = *whole_->header().directory_pages;
    const std::string all = bytes();
    const uint64_t size = pages_bytes(whole_->nodes().size(), kPageNodes);
    for (uint64_t at = 0; at < size; at += 7) {
        std::string damaged = all;
        damaged[pages.offset + at] ^= 0x10;
        EXPECT_FALSE(CacheFile::open(write(damaged), 0)) << at;
        EXPECT_FALSE(CacheFile::open(write(damaged), kWholeDirectory)) << at;
    }
}

TEST_F(PagedCache, RejectsForgedPlacesAndSizesOfPages) {
    const DirectoryPages pages = *whole_->header().directory_pages;
    const auto text = [](const char* name, uint64_t value) { return fmt::format("\"{}\": {}", name, value); };
    const std::string nodes = text("nodes", kPageNodes), offset = text("offset", pages.offset);
    const std::pair<std::string, std::string> forgeries[] = {{nodes, "\"nodes\": 0"},
                                                             {nodes, "\"nodes\": 7"},
                                                             {nodes, "\"nodes\": 65537"},
                                                             {nodes, "\"nodes\": -16"},
                                                             {nodes, "\"nodes\": 32"},
                                                             {nodes, "\"nodes\": 1e9"},
                                                             {nodes, "\"nodes\": \"16\""},
                                                             {offset, "\"offset\": 9"},
                                                             {offset, "\"offset\": 1e30"},
                                                             {offset, text("offset", ~0ull)},
                                                             {offset, text("offset", pages.offset + 16)}};
    for (const auto& [from, to] : forgeries) {
        const auto path = with_metadata(bytes(), from, to);
        EXPECT_FALSE(CacheFile::open(path, 0)) << to;
        EXPECT_FALSE(CacheFile::open(path, kWholeDirectory)) << to;
    }
    EXPECT_TRUE(CacheFile::open(with_metadata(bytes(), "\"directory_pages\"", "\"directory_leaves\""), 0))
        << "without a list of pages the directory is read whole";
}

/// Forged entries and lists of pages, with right checksums: an error, or nodes that are consistent as far as
/// one can see from a page.
TEST_F(PagedCache, ForgedPagesAreRejectedOrHarmless) {
    const auto count = static_cast<uint32_t>(whole_->nodes().size());
    const std::function<void(format::Entry&)> changes[] = {[](auto& e) { e.child_mask ^= 1; },
                                                           [](auto& e) { e.key.x ^= 1; },
                                                           [](auto& e) { e.key.level ^= 1; },
                                                           [](auto& e) { e.count = 1 << 30; },
                                                           [](auto& e) { e.subtree_count = ~0ull; },
                                                           [](auto& e) { e.payload_offset = ~0ull; },
                                                           [](auto& e) { e.payload_bytes ^= 64; },
                                                           [](auto& e) { e.codec = 9; },
                                                           [](auto& e) { e.layout = 1; },
                                                           [](auto& e) { e.area_floor[2] = NAN; }};
    for (const auto& change : changes)
        for (const uint32_t node : {0u, 5u, kPageNodes - 1, kPageNodes, count / 2, count - 1}) {
            const auto cache = CacheFile::open(with_entry(node, change), 0);
            if (!cache) continue;
            EXPECT_FALSE((*cache)->load(node)) << node;
            (void)(*cache)->nodes()[node];
            EXPECT_FALSE((*cache)->directory_state()) << node;
            const Cut cut = full_cut(**cache);
            EXPECT_LE(cut.points, whole_->header().points);
        }
    const DirectoryPages pages = *whole_->header().directory_pages;
    const uint64_t list = pages_bytes(count, kPageNodes) / format::kPageBytes;
    for (const uint64_t page : {uint64_t{0}, uint64_t{1}, list / 2, list - 1})
        for (const uint32_t forged_child : {0u, 1u, 7u, count / 3, count - 1, count, count + 1, UINT32_MAX}) {
            std::string all = bytes();
            if (forged_child == format::load_page(reinterpret_cast<const std::byte*>(
                                                      &all[pages.offset + page * format::kPageBytes]))
                                    .first_child)
                continue;
            io::store(reinterpret_cast<std::byte*>(&all[pages.offset + page * format::kPageBytes + 8]),
                      forged_child);
            const auto cache = CacheFile::open(forged(all), 0);
            if (cache) {
                for (uint32_t i = 0; i < count; ++i) {
                    const NodeInfo node = (*cache)->nodes()[i];
                    EXPECT_TRUE(node.child_mask == 0 || (node.first_child > i && node.first_child < count));
                    EXPECT_TRUE(node.parent == kNoNode || node.parent < i);
                }
            }
            EXPECT_FALSE(CacheFile::open(forged(all), kWholeDirectory)) << page << ' ' << forged_child;
        }
}

TEST_F(PagedCache, ACacheGetsPagesOnlyIfItsDirectoryIsLarge) {
    const test::ComputedSource source(header_.schema, 20'000, [](uint64_t index, std::byte* record) {
        Random random(2, index);
        for (int axis = 0; axis < 3; ++axis)
            io::store(record + 4 * axis, static_cast<float>(random.uniform()));
    });
    BuildOptions options;
    options.inputs = {&source};
    options.output = folder_ / "small.luc";
    ASSERT_TRUE(build_cache(options));
    EXPECT_FALSE(CacheFile::open(options.output).value()->header().directory_pages);
    ASSERT_TRUE(test::give_pages(options.output, 8));
    const auto paged = CacheFile::open(options.output, 0).value();
    EXPECT_TRUE(paged->header().directory_pages);
    EXPECT_EQ(full_cut(*paged).points, 20'000u);
}

TEST(LargeCache, OpensWithFewPagesOfItsDirectory) {
    const lucarne::test::TempFolder folder;
    const auto header = lucarne::test::write_large_cache(folder / "sparse.luc");
    if (!header) GTEST_SKIP() << header.error().line();
    ASSERT_GT(header->points, uint64_t{1} << 32);
    ASSERT_GT(std::filesystem::file_size(folder / "sparse.luc"), uint64_t{1} << 40);

    const auto paged = CacheFile::open(folder / "sparse.luc").value();
    const auto whole = CacheFile::open(folder / "sparse.luc", kWholeDirectory).value();
    ASSERT_GT(whole->directory_bytes(), kDirectoryMemory);
    EXPECT_LE(paged->directory_bytes(), kDirectoryMemory + (uint64_t{1} << 20));
    EXPECT_EQ(paged->header().points, header->points);
    View view;
    view.position = {.5, .5, .5};
    view.width = view.height = 512;
    const Cut seen = view_cut(*paged, view, 50'000'000), expected = view_cut(*whole, view, 50'000'000);
    EXPECT_EQ(seen.points, expected.points);
    EXPECT_EQ(seen.nodes.size(), expected.nodes.size());
    for (uint32_t node = 0; node < whole->nodes().size(); node += 997)
        ASSERT_TRUE(paged->nodes()[node] == whole->nodes()[node]) << node;
    EXPECT_TRUE(paged->directory_state());
}

}  // namespace
}  // namespace lucarne::octree
