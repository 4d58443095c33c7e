// Fuzzes the reader of bake files. The checksums would stop any mutated file, so they are corrected first:
// the aim is to test deliberate lies, not accidents.
#include <cstdlib>
#include <cstring>

#include <xxhash.h>

#include "gi/bake/bake_file.h"
#include "tests/fuzz/fuzz.h"

namespace lucarne::gi {
namespace {

constexpr uint64_t kMostBytes = 1 << 20;
// Places in a bake file, see gi/bake/README.md.
constexpr size_t kHead = 112, kSections = 96, kHeadChecksum = 104;
constexpr size_t kEntry = 96, kStored = 72, kOffset = 80, kChecksum = 88;

template <class T>
T value_at(const std::string& bytes, size_t at) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
}

void correct_checksums(std::string& bytes) {
    if (bytes.size() < kHead) return;
    const auto sections = value_at<uint32_t>(bytes, kSections);
    if (sections > (bytes.size() - kHead) / kEntry) return;
    for (size_t at = kHead; at < kHead + sections * kEntry; at += kEntry) {
        const auto stored = value_at<uint64_t>(bytes, at + kStored),
                   offset = value_at<uint64_t>(bytes, at + kOffset);
        if (offset > bytes.size() || stored > bytes.size() - offset) continue;
        const uint64_t sum = XXH3_64bits(&bytes[offset], stored);
        std::memcpy(&bytes[at + kChecksum], &sum, sizeof sum);
    }
    std::memset(&bytes[kHeadChecksum], 0, 8);
    const uint64_t sum =
        XXH3_64bits_withSeed(&bytes[kHead], sections * kEntry, XXH3_64bits(bytes.data(), kHead));
    std::memcpy(&bytes[kHeadChecksum], &sum, sizeof sum);
}

}  // namespace
}  // namespace lucarne::gi

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    using namespace gi;
    std::string bytes(reinterpret_cast<const char*>(data), size);
    bytes += '\0';  // so that empty sections have an address
    correct_checksums(bytes);
    const MemorySource file("fuzz.bake", std::as_bytes(std::span(bytes)));
    const auto header = read_bake_header(file);
    const auto bake = read_bake(file, kMostBytes);
    if (!bake) return true;
    uint64_t sum = 0;
    for (const auto& [name, section] : bake->sections) sum += section.size();
    if (!header || !(*header == bake->header) || sum > kMostBytes) std::abort();
    return true;
}
