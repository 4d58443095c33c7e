// Fuzzes the cache reader and the code that trusts it. The checksums would stop any mutated cache, so they
// are corrected first: the aim is to test deliberate lies, not accidents. The input is a cache without the
// zeros after the fields of its superblocks: the first 88 bytes of the file and everything from byte 8192 on.
#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include "gi/scene/scene.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/cache/file.h"
#include "octree/cache/format.h"
#include "octree/stream/cut.h"
#include "tests/fuzz/fuzz.h"

namespace lucarne::octree {
namespace {

constexpr size_t kFields = 88;

/// Returns a part of the file; empty if it reaches beyond the file.
std::span<std::byte> part(std::span<std::byte> file, uint64_t offset, uint64_t bytes) {
    if (offset > file.size() || bytes > file.size() - offset) return {};
    return file.subspan(offset, bytes);
}

/// Returns the digits that follow `key` and a colon in `text`, from `begin` on; empty if there are none.
std::string_view digits_after(std::string_view text, std::string_view key, size_t begin) {
    const size_t at = text.find(key, begin);
    if (at == std::string_view::npos) return {};
    const size_t first = std::min(text.find_first_not_of(' ', at + key.size()), text.size());
    return text.substr(first, text.find_first_not_of("0123456789", first) - first);
}
uint64_t number_of(std::string_view digits) {
    uint64_t number = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return number;
}

/// The metadata's text. It is handled as text, because metadata may be no JSON or nested a million times.
std::string metadata_of(std::string& bytes) {
    uint64_t place[2];  // offset, bytes
    std::memcpy(place, &bytes[48], sizeof place);
    const auto stored = part(std::as_writable_bytes(std::span(bytes)), place[0], place[1]);
    return {reinterpret_cast<const char*>(stored.data()), stored.size()};
}

/// Corrects the checksum that follows `begin` in the metadata's text: appends metadata with the right one to
/// the file.
void put_checksum(std::string& bytes, const std::string& text, size_t begin, uint64_t sum) {
    const auto checksum = digits_after(text, "\"checksum\":", begin);
    if (checksum.empty()) return;
    const size_t at = static_cast<size_t>(checksum.data() - text.data());
    const std::string corrected =
        text.substr(0, at) + std::to_string(sum) + text.substr(at + checksum.size());
    if (corrected == text) return;
    const uint64_t place[2] = {bytes.size(), corrected.size()};
    std::memcpy(&bytes[48], place, sizeof place);
    bytes += corrected;
}

void reseal_filling(std::string& bytes) {
    const std::string text = metadata_of(bytes);
    const size_t filling = text.find("\"filling\"");
    if (filling == std::string::npos) return;
    const auto number = [&](const char* name) { return number_of(digits_after(text, name, filling)); };
    const auto file = std::as_writable_bytes(std::span(bytes));
    put_checksum(bytes, text, filling,
                 format::checksum(part(file, number("\"offset\":"), number("\"bytes\":"))));
}

/// Corrects the checksums of the directory's pages, and that of their list.
void reseal_pages(std::string& bytes) {
    const std::string text = metadata_of(bytes);
    const size_t pages = text.find("\"directory_pages\"");
    if (pages == std::string::npos) return;
    const auto number = [&](const char* name) { return number_of(digits_after(text, name, pages)); };
    const auto file = std::as_writable_bytes(std::span(bytes));
    uint64_t place[2];  // offset, bytes
    std::memcpy(place, &bytes[24], sizeof place);
    const auto directory = part(file, place[0], place[1]);
    const uint64_t step = std::min<uint64_t>(number("\"nodes\":"), 1 << 20) * format::kEntryBytes;
    if (step == 0) return;
    const auto list =
        part(file, number("\"offset\":"), (directory.size() + step - 1) / step * format::kPageBytes);
    for (size_t at = 0, page = 0; at < directory.size() && !list.empty(); at += step, ++page)
        io::store(&list[page * format::kPageBytes],
                  format::checksum(directory.subspan(at, std::min<size_t>(step, directory.size() - at))));
    put_checksum(bytes, text, pages, format::checksum(list));
}

void reseal_entries(std::string& bytes) {
    const auto file = std::as_writable_bytes(std::span(bytes));
    uint64_t place[2];  // offset, bytes
    std::memcpy(place, &bytes[24], sizeof place);
    const auto directory = part(file, place[0], place[1]);
    for (size_t at = 0; at + format::kEntryBytes <= directory.size(); at += format::kEntryBytes) {
        format::Entry entry = format::load_entry(&directory[at]);
        entry.checksum = format::checksum(part(file, entry.payload_offset, entry.payload_bytes));
        format::store_entry(entry, &directory[at]);
    }
}

/// Corrects magic, version, size and every checksum.
void reseal(std::string& bytes) {
    reseal_filling(bytes);
    reseal_entries(bytes);
    reseal_pages(bytes);
    const auto file = std::as_writable_bytes(std::span(bytes));
    uint64_t fields[8];
    std::memcpy(fields, &file[16], sizeof fields);
    format::Superblock block{fields[0], fields[1], fields[2], 0, fields[4], fields[5], 0, file.size()};
    const auto directory = part(file, block.directory_offset, block.directory_bytes);
    block.directory_checksum = format::checksum(directory);
    block.metadata_checksum = format::checksum(part(file, block.metadata_offset, block.metadata_bytes));
    const auto encoded = format::encode(block);
    std::copy(encoded.begin(), encoded.end(), file.begin());
    std::copy(encoded.begin(), encoded.end(), file.begin() + format::kSuperblockBytes);
}

/// Reads every node as rendering would, and selects cuts by what the directory claims.
void use(const NodeSource& source) {
    const auto& header = source.header();
    const gi::Scene scene = gi::default_scene(header.min, header.max, header.metres_per_unit);
    (void)source.fillings();
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const auto data = source.load(node);
        if (data) (void)gi::pack_surfels(header, source.nodes()[node], *data, scene);
    }
    View view;
    view.position = scene.cameras[0].position;
    view.width = view.height = 64;
    (void)view_cut(source, view, 1000);
    (void)light_view_cut(source, view, 1000);
    (void)light_cut(source, header.min, 1000);
}

}  // namespace
}  // namespace lucarne::octree

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    if (size < octree::kFields) return false;
    std::string bytes(octree::format::kFirstPayload + size - octree::kFields, '\0');
    std::memcpy(bytes.data(), data, octree::kFields);
    std::memcpy(&bytes[octree::format::kFirstPayload], data + octree::kFields, size - octree::kFields);
    octree::reseal(bytes);
    const auto file = memory_source(bytes);
    // With the directory whole in memory, and with the fewest pages.
    for (const uint64_t memory : {octree::kWholeDirectory, uint64_t{0}}) {
        (void)octree::verify_cache(
            file, [](uint64_t) {}, memory);
        const auto opened = octree::CacheFile::open(file, memory);
        if (opened) octree::use(**opened);
    }
    return true;
}
