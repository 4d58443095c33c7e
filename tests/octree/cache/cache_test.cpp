// Tests the cache reader against every kind of damage, including false contents with correct checksums.
#include "octree/cache/cache.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/file.h"
#include "octree/convert/build.h"
#include "octree/open.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using format::kEntryBytes;
using format::kSuperblockBytes;

class Cache : public testing::Test {
 protected:
    void SetUp() override {
        io::Schema schema;
        schema.position = io::PositionType::f32;
        schema.stride = 12;
        schema.add("color", io::ScalarType::u8, 3);
        const test::ComputedSource source(schema, 60'000, [](uint64_t index, std::byte* record) {
            Random random(2, index);
            for (int axis = 0; axis < 3; ++axis)
                io::store(record + 4 * axis, static_cast<float>(axis == 2 ? 0.0 : 10 * random.uniform()));
            io::store(record + 12, static_cast<uint8_t>(index));
        });
        BuildOptions options;
        options.inputs = {&source};
        options.output = path();
        options.normals = NormalsMode::none;
        ASSERT_TRUE(build_cache(options));
        std::ifstream in(path(), std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(in), {});
        block_ = *format::decode(std::as_bytes(std::span(bytes_)).first<kSuperblockBytes>());
    }

    std::filesystem::path path() const { return folder_ / "cache.luc"; }
    std::filesystem::path write(const std::string& bytes) const {
        const auto name = folder_ / "damaged.luc";
        std::ofstream(name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return name;
    }
    size_t nodes() const { return block_.directory_bytes / kEntryBytes; }

    /// Returns the file with one directory entry changed and every checksum recomputed, as in a forged file.
    template <class Change>
    std::string with_entry(size_t node, const Change& change) const {
        std::string bytes = bytes_;
        auto* at = reinterpret_cast<std::byte*>(bytes.data()) + block_.directory_offset + node * kEntryBytes;
        format::Entry entry = format::load_entry(at);
        change(entry);
        format::store_entry(entry, at);
        return resealed(bytes, block_);
    }
    /// Returns the file with another metadata text of the same length.
    std::string with_metadata(const std::string& from, const std::string& to) const {
        std::string bytes = bytes_;
        const auto at = bytes.find(from, block_.metadata_offset);
        EXPECT_NE(at, std::string::npos) << from;
        EXPECT_EQ(from.size(), to.size());
        bytes.replace(at, to.size(), to);
        return resealed(bytes, block_);
    }
    /// Returns the file with these records as codec 0 of a node, after its end.
    std::string with_raw_node(size_t node, const std::vector<std::byte>& records) const {
        std::string bytes =
            bytes_ + std::string(reinterpret_cast<const char*>(records.data()), records.size());
        auto* at = reinterpret_cast<std::byte*>(bytes.data()) + block_.directory_offset + node * kEntryBytes;
        format::Entry entry = format::load_entry(at);
        entry.codec = format::kCodecRaw;
        entry.payload_offset = bytes_.size();
        entry.payload_bytes = static_cast<uint32_t>(records.size());
        entry.checksum = format::checksum(records);
        format::store_entry(entry, at);
        format::Superblock block = block_;
        block.file_bytes = bytes.size();
        return resealed(bytes, block);
    }
    static std::string resealed(std::string bytes, format::Superblock block) {
        const auto all = std::as_bytes(std::span(bytes));
        block.directory_checksum =
            format::checksum(all.subspan(block.directory_offset, block.directory_bytes));
        block.metadata_checksum = format::checksum(all.subspan(block.metadata_offset, block.metadata_bytes));
        return with_superblock(std::move(bytes), block);
    }
    static std::string with_superblock(std::string bytes, const format::Superblock& block) {
        const auto encoded = format::encode(block);
        std::memcpy(bytes.data(), encoded.data(), kSuperblockBytes);
        std::memcpy(bytes.data() + kSuperblockBytes, encoded.data(), kSuperblockBytes);
        return bytes;
    }
    void expect_rejected(const std::string& bytes, const std::string& why) {
        const auto opened = open_cache(write(bytes));
        ASSERT_FALSE(opened) << why;
        EXPECT_EQ(opened.error().kind, ErrorKind::input_rejected) << why;
        EXPECT_NE(opened.error().line().find(why), std::string::npos)
            << opened.error().line() << " should say: " << why;
    }

    const test::TempFolder folder_;
    std::string bytes_;
    format::Superblock block_;
};

TEST_F(Cache, OpensTheVersionsThatItKnows) {
    EXPECT_EQ(block_.version, format::kVersion) << "few scans keep the version that all readers know";
    for (uint32_t version = 0; version < 6; ++version) {
        format::Superblock block = block_;
        block.version = version;
        const std::string bytes = with_superblock(bytes_, block);
        if (version == format::kVersion || version == format::kWideVersion)
            EXPECT_TRUE(open_cache(write(bytes))) << version;
        else
            expect_rejected(bytes, "is not a cache of this version");
    }
}

TEST_F(Cache, OpensFromEitherSuperblockAndVerifyMissesTheOther) {
    for (const size_t broken : {size_t{0}, kSuperblockBytes}) {
        std::string bytes = bytes_;
        bytes[broken + 30] ^= 1;
        const auto name = write(bytes);
        EXPECT_TRUE(open_cache(name));
        const auto verified = verify_cache(name, [](uint64_t) {});
        ASSERT_FALSE(verified);
        EXPECT_NE(verified.error().line().find("superblock"), std::string::npos);
    }
    std::string bytes = bytes_;
    bytes[30] ^= 1;
    bytes[kSuperblockBytes + 30] ^= 1;
    expect_rejected(bytes, "superblocks are damaged");
}

TEST_F(Cache, TakesTheSuperblockOfTheHigherGeneration) {
    format::Superblock next = block_;
    next.generation = 2;
    next.directory_offset = 1;  // if this superblock is used, the cache does not open
    std::string bytes = bytes_;
    const auto encoded = format::encode(next);
    std::memcpy(bytes.data() + kSuperblockBytes, encoded.data(), kSuperblockBytes);
    expect_rejected(bytes, "points outside the file");
    next.generation = 0;
    const auto older = format::encode(next);
    std::memcpy(bytes.data() + kSuperblockBytes, older.data(), kSuperblockBytes);
    EXPECT_TRUE(open_cache(write(bytes)));
}

TEST_F(Cache, RejectsEveryTruncation) {
    for (size_t length = 0; length < bytes_.size(); length += 1 + bytes_.size() / 97)
        EXPECT_FALSE(open_cache(write(bytes_.substr(0, length)))) << length << " bytes";
    EXPECT_FALSE(open_cache(write(bytes_.substr(0, bytes_.size() - 1))));
}

TEST_F(Cache, VerifyFindsAFlippedBitAnywhere) {
    Random random(9);
    for (int i = 0; i < 300; ++i) {
        const size_t at = i < 176 ? static_cast<size_t>(i % 88) + (i < 88 ? 0 : kSuperblockBytes)
                                  : random.next() % bytes_.size();
        std::string bytes = bytes_;
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.next() % 8));
        EXPECT_FALSE(verify_cache(write(bytes), [](uint64_t) {})) << "byte " << at;
    }
}

TEST_F(Cache, VerifyFindsBytesBehindTheEnd) {
    const auto name = write(bytes_ + "x");
    EXPECT_TRUE(open_cache(name)) << "an interrupted append must not lose the old state";
    const auto verified = verify_cache(name, [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    EXPECT_EQ(verified->bytes_behind_end, 1u);
    EXPECT_EQ(verify_cache(write(bytes_), [](uint64_t) {})->bytes_behind_end, 0u);
}

TEST_F(Cache, RejectsLyingSuperblocks) {
    const auto lie = [&](auto member, uint64_t value) {
        format::Superblock block = block_;
        block.*member = value;
        return with_superblock(bytes_, block);
    };
    for (const uint64_t value :
         {uint64_t{0}, uint64_t{8191}, block_.file_bytes, UINT64_MAX - 63, UINT64_MAX}) {
        EXPECT_FALSE(open_cache(write(lie(&format::Superblock::directory_offset, value)))) << value;
        EXPECT_FALSE(open_cache(write(lie(&format::Superblock::metadata_offset, value)))) << value;
        EXPECT_FALSE(open_cache(write(lie(&format::Superblock::directory_bytes, value & ~uint64_t{63}))))
            << value;
        EXPECT_FALSE(open_cache(write(lie(&format::Superblock::metadata_bytes, value)))) << value;
    }
    expect_rejected(lie(&format::Superblock::file_bytes, UINT64_MAX), "ends early");
}

TEST_F(Cache, RejectsLyingDirectories) {
    using format::Entry;
    const size_t last = nodes() - 1;
    ASSERT_GT(last, 4u);
    expect_rejected(with_entry(last, [](Entry& e) { e.count += 1; }), "do not add up");
    expect_rejected(with_entry(last, [](Entry& e) { e.count += 1, e.subtree_count += 1; }), "do not add up");
    expect_rejected(with_entry(0, [](Entry& e) { e.subtree_count = UINT64_MAX; }), "do not add up");
    expect_rejected(with_entry(last, [](Entry& e) { e.key.level = 32; }), "outside the root cube");
    expect_rejected(with_entry(last, [](Entry& e) { e.key.x = 1u << 31; }), "outside the root cube");
    expect_rejected(with_entry(last, [](Entry& e) { e.key.x ^= 1; }), "not where they belong");
    expect_rejected(with_entry(last, [](Entry& e) { e.child_mask = 255; }), "not where they belong");
    const auto cache = CacheFile::open(path());
    const size_t parent = (*cache)->nodes()[last].parent;
    expect_rejected(with_entry(parent,
                               [](Entry& e) {
                                   e.child_mask &=
                                       static_cast<uint8_t>(0xff >> (__builtin_clz(e.child_mask) - 23));
                               }),
                    "has no parent");
    expect_rejected(with_entry(0, [](Entry& e) { e.child_mask = 0; }), "not where they belong");
    expect_rejected(with_entry(0, [](Entry& e) { e.key.level = 1; }), "no root node");
    expect_rejected(with_entry(last, [](Entry& e) { e.codec = 2; }), "unknown codec 2");
    expect_rejected(with_entry(last, [](Entry& e) { e.codec = format::kCodecRaw; }), "states a wrong size");
    expect_rejected(with_entry(last, [](Entry& e) { e.payload_bytes = e.count * 15; }),
                    "states a wrong size");
    expect_rejected(with_entry(last, [](Entry& e) { e.payload_offset = UINT64_MAX; }), "outside the file");
    expect_rejected(with_entry(last, [](Entry& e) { e.payload_offset = 0; }), "outside the file");
    expect_rejected(with_entry(last, [](Entry& e) { e.payload_offset += 15; }), "overlap");
    expect_rejected(with_entry(last, [](Entry& e) { e.payload_bytes += 1; }), "overlap");
    expect_rejected(with_entry(last, [](Entry& e) { e.area_floor[2] = NAN; }), "area floor");
    expect_rejected(with_entry(last, [](Entry& e) { e.area_floor[0] = -1; }), "area floor");
}

TEST_F(Cache, RejectsLyingMetadata) {
    expect_rejected(with_metadata("\"f32\"", "\"f16\""), "unknown position type");
    expect_rejected(with_metadata("\"components\": 3", "\"components\": 0"), "components");
    expect_rejected(with_metadata("\"points\": 60000", "\"points\": 60001"), "disagree");
    expect_rejected(with_metadata("\"scans\"", "\"scanz\""), "scans");
    expect_rejected(with_metadata("\"metres_per_unit\": 1", "\"metres_per_unit\": 0"), "unit");
    std::string nested = bytes_;
    nested.replace(block_.metadata_offset, block_.metadata_bytes, std::string(block_.metadata_bytes, '['));
    expect_rejected(resealed(nested, block_), "nested too deep");
}

TEST_F(Cache, VerifyFindsPointsOutsideTheirCube) {
    // Every checksum and count is right; one point is outside its cube.
    std::vector<size_t> leaves;
    const auto cache = CacheFile::open(path());
    for (size_t i = 0; i < nodes(); ++i)
        if ((*cache)->nodes()[i].child_mask == 0) leaves.push_back(i);
    ASSERT_FALSE(leaves.empty());
    NodeData data = (*cache)->load(static_cast<uint32_t>(leaves[0])).value();
    io::store(data.records.data(), io::load<float>(data.records.data()) < 5 ? 9.0f : 1.0f);
    const auto name = write(with_raw_node(leaves[0], data.records));
    EXPECT_TRUE(open_cache(name));
    const auto verified = verify_cache(name, [](uint64_t) {});
    ASSERT_FALSE(verified);
    EXPECT_NE(verified.error().line().find("lies outside its cube"), std::string::npos)
        << verified.error().line();
}

TEST_F(Cache, NodesMayBeCompressedOrRaw) {
    const auto cache = CacheFile::open(path()).value();
    uint64_t stored = 0;
    for (const auto& node : cache->nodes()) stored += node.payload_bytes;
    EXPECT_LT(stored, 60'000u * 15 * 2 / 3) << "compressed";
    const NodeData data = cache->load(2).value();
    const auto name = write(with_raw_node(2, data.records));
    EXPECT_TRUE(verify_cache(name, [](uint64_t) {}));
    EXPECT_EQ(CacheFile::open(name).value()->load(2).value().records, data.records);
}

TEST_F(Cache, CompressedPayloadsThatLieAreRefusedOrHarmless) {
    size_t refused = 0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        Random random(3, seed);
        const size_t node = random.next() % nodes();
        std::string bytes = bytes_;
        auto* at = reinterpret_cast<std::byte*>(bytes.data());
        auto* entry_at = at + block_.directory_offset + node * kEntryBytes;
        format::Entry entry = format::load_entry(entry_at);
        if (entry.payload_bytes == 0) continue;
        // Half of the flips hit the heads.
        const size_t most = seed % 2 ? entry.payload_bytes : std::min(entry.payload_bytes, 64u);
        at[entry.payload_offset + random.next() % most] ^= static_cast<std::byte>(1 + random.next() % 255);
        entry.checksum = format::checksum({at + entry.payload_offset, entry.payload_bytes});
        format::store_entry(entry, entry_at);
        const auto opened = open_cache(write(resealed(bytes, block_)));
        ASSERT_TRUE(opened);
        const auto loaded = (*opened)->load(static_cast<uint32_t>(node));
        if (loaded) {
            EXPECT_EQ(loaded->records.size(), size_t{entry.count} * 15);
        } else {
            EXPECT_NE(loaded.error().line().find("do not decode"), std::string::npos);
            ++refused;
        }
    }
    EXPECT_GT(refused, 20u);
}

TEST_F(Cache, OutOfMemoryIsReadAsFromAFile) {
    const auto memory = std::make_shared<const MemorySource>("memory.luc", std::as_bytes(std::span(bytes_)));
    const auto a = open_octree(path()), b = open_octree(memory);
    ASSERT_TRUE(a && b);
    ASSERT_EQ((*a)->nodes().size(), (*b)->nodes().size());
    for (uint32_t node = 0; node < (*a)->nodes().size(); ++node)
        EXPECT_EQ((*a)->load(node)->records, (*b)->load(node)->records);
    EXPECT_EQ(verify_cache(memory, [](uint64_t) {})->points, 60'000u);
    const auto short_of_one = std::as_bytes(std::span(bytes_)).first(bytes_.size() - 1);
    EXPECT_FALSE(open_octree(std::make_shared<const MemorySource>("cut.luc", short_of_one)));
}

TEST_F(Cache, IsToldFromOtherFilesByItsContent) {
    EXPECT_TRUE(is_cache(*InputFile::open(path())));
    EXPECT_FALSE(is_cache(*InputFile::open(write("ply\n"))));
    EXPECT_FALSE(is_cache(*InputFile::open(write(""))));
    EXPECT_TRUE(is_octree(path()));
    EXPECT_FALSE(is_octree(folder_.path()));
    EXPECT_FALSE(is_octree(folder_ / "absent"));
}

}  // namespace
}  // namespace lucarne::octree
