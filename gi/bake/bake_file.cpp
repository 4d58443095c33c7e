#include "gi/bake/bake_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include "io/files/file.h"
#include "io/files/user_folder.h"

namespace lucarne::gi {
namespace {

static_assert(std::endian::native == std::endian::little, "bake files are written as they lie in memory");

constexpr std::array<char, 8> kMagic = {'L', 'U', 'C', 'B', 'A', 'K', 'E', 0x1a};
constexpr uint32_t kFormat = 1;
constexpr uint32_t kMostSections = 64;
constexpr size_t kMostName = 64;
constexpr int kLevel = 1;  // of zstd: fast, because bakes are written while pictures are drawn

struct Head {
    std::array<char, 8> magic = kMagic;
    uint32_t format = kFormat, version = 0;
    uint64_t key = 0;
    double share = 0;
    std::array<char, kMostName> engine{};
    uint32_t sections = 0, unused = 0;
    uint64_t checksum = 0;  // of this with 0 in its place, and the list of sections
};
static_assert(sizeof(Head) == 112);

struct Entry {
    std::array<char, kMostName> name{};
    uint64_t bytes = 0, stored = 0, offset = 0, checksum = 0;
};
static_assert(sizeof(Entry) == 96);

bool store_name(std::string_view name, std::array<char, kMostName>& target) {
    if (name.empty() || name.size() > kMostName) return false;
    std::ranges::copy(name, target.begin());
    return true;
}

std::string loaded_name(const std::array<char, kMostName>& stored) {
    return {stored.begin(), std::ranges::find(stored, '\0')};
}

uint64_t checksum(Head head, std::span<const Entry> entries) {
    head.checksum = 0;
    return XXH3_64bits_withSeed(entries.data(), entries.size_bytes(), XXH3_64bits(&head, sizeof(head)));
}

tl::unexpected<Error> damaged(const ByteSource& file, std::string_view what) {
    return rejected(file.path().string(), fmt::format("{} of the bake file is damaged", what));
}

/// Reads the head and the list of sections.
Result<std::pair<Head, std::vector<Entry>>> read_list(const ByteSource& file) {
    Head head;
    if (file.size() < sizeof(head)) return rejected(file.path().string(), "it is no bake file");
    LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(&head, 1))));
    if (head.magic != kMagic) return rejected(file.path().string(), "it is no bake file");
    if (head.format != kFormat)
        return rejected(file.path().string(), fmt::format("it has format {} of bake files", head.format));
    if (head.sections > kMostSections || sizeof(head) + head.sections * sizeof(Entry) > file.size())
        return damaged(file, "the head");
    std::vector<Entry> entries(head.sections);
    LUCARNE_TRY(file.read_at(sizeof(head), std::as_writable_bytes(std::span(entries))));
    if (head.checksum != checksum(head, entries) || !(head.share >= 0 && head.share <= 1))
        return damaged(file, "the head");
    return std::pair(head, std::move(entries));
}

BakeHeader header_of(const Head& head) {
    return {loaded_name(head.engine), head.version, head.key, head.share};
}

Result<std::vector<std::byte>> read_section(const ByteSource& file, const Entry& entry) {
    std::vector<std::byte> stored(entry.stored);
    LUCARNE_TRY(file.read_at(entry.offset, stored));
    if (XXH3_64bits(stored.data(), stored.size()) != entry.checksum ||
        ZSTD_getFrameContentSize(stored.data(), stored.size()) != entry.bytes)
        return damaged(file, "a section");
    std::vector<std::byte> bytes(entry.bytes);
    const size_t size = ZSTD_decompress(bytes.data(), bytes.size(), stored.data(), stored.size());
    if (ZSTD_isError(size) || size != bytes.size()) return damaged(file, "a section");
    return bytes;
}

}  // namespace

Result<void> write_bake(const std::filesystem::path& path, const BakeFile& bake) {
    Head head;
    head.version = bake.header.version;
    head.key = bake.header.key;
    head.share = bake.header.share;
    head.sections = static_cast<uint32_t>(bake.sections.size());
    if (!store_name(bake.header.engine, head.engine) || bake.sections.size() > kMostSections)
        return failed(path.string(), "too many sections, or a name that is too long");
    std::vector<Entry> entries;
    LUCARNE_ASSIGN(OutputFile file, OutputFile::create(path, true));
    uint64_t offset = sizeof(head) + bake.sections.size() * sizeof(Entry);
    for (const auto& [name, bytes] : bake.sections) {
        Entry& entry = entries.emplace_back();
        if (!store_name(name, entry.name)) return failed(path.string(), "a section's name is too long");
        std::vector<std::byte> stored(ZSTD_compressBound(bytes.size()));
        const size_t size = ZSTD_compress(stored.data(), stored.size(), bytes.data(), bytes.size(), kLevel);
        if (ZSTD_isError(size)) return failed(path.string(), ZSTD_getErrorName(size));
        stored.resize(size);
        entry.bytes = bytes.size();
        entry.stored = size;
        entry.offset = offset;
        entry.checksum = XXH3_64bits(stored.data(), size);
        LUCARNE_TRY(file.write_at(offset, stored));
        offset += size;
    }
    head.checksum = checksum(head, entries);
    LUCARNE_TRY(file.write_at(0, std::as_bytes(std::span(&head, 1))));
    LUCARNE_TRY(file.write_at(sizeof(head), std::as_bytes(std::span(entries))));
    return file.commit();
}

Result<BakeFile> read_bake(const ByteSource& file, uint64_t most_bytes) {
    LUCARNE_ASSIGN(const auto list, read_list(file));
    const auto& [head, entries] = list;
    uint64_t sum = 0;
    for (const Entry& entry : entries) {
        if (entry.offset > file.size() || entry.stored > file.size() - entry.offset ||
            entry.bytes > most_bytes)
            return damaged(file, "a section");
        sum += entry.bytes;
    }
    if (sum > most_bytes)
        return rejected(file.path().string(),
                        fmt::format("it is larger than {} bytes when unpacked", most_bytes));
    BakeFile bake{header_of(head), {}};
    for (const Entry& entry : entries) {
        LUCARNE_ASSIGN(bake.sections[loaded_name(entry.name)], read_section(file, entry));
    }
    return bake;
}

Result<BakeHeader> read_bake_header(const ByteSource& file) {
    LUCARNE_ASSIGN(const auto list, read_list(file));
    return header_of(list.first);
}

Result<BakeHeader> read_bake_header(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const auto file, InputFile::open_shared(path));
    return read_bake_header(*file);
}

std::filesystem::path bake_beside(const std::filesystem::path& cache, std::string_view engine) {
    return fmt::format("{}.{}.bake", cache.string(), engine);
}

std::filesystem::path bake_place(const std::filesystem::path& cache, std::string_view engine) {
    const std::filesystem::path beside = bake_beside(cache, engine);
    if (check_output(beside, true)) return beside;
    const std::filesystem::path folder = user_folder("XDG_CACHE_HOME", ".cache");
    if (folder.empty()) return {};
    std::error_code unknown;
    const auto whole = std::filesystem::absolute(cache, unknown);
    std::filesystem::create_directories(folder, unknown);
    const std::filesystem::path file =
        bake_beside(folder / kept_name((unknown ? cache : whole).string()), engine);
    return check_output(file, true) ? file : std::filesystem::path();
}

}  // namespace lucarne::gi
