#include "tests/fuzz/fuzz_scan.h"
#include "tests/io/formats/e57/e57_builder.h"

/// The input is an E57 file without checksums, which would stop every mutation. They are added here, and the
/// header is corrected: the aim is to test deliberate lies, not accidents.
bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    using namespace io;
    std::string logical(reinterpret_cast<const char*>(data), size);
    if (size < e57::kHeaderBytes) return false;
    std::string header("ASTM-E57\1\0\0\0\0\0\0\0", 16);
    testing::put(header, (size + e57::kPageContent - 1) / e57::kPageContent * e57::kPageBytes);
    logical.replace(0, header.size(), header);
    if (const size_t xml = logical.find("<?xml"); xml != logical.npos && xml >= e57::kHeaderBytes) {
        std::string place;
        testing::put(place, testing::physical(xml));
        testing::put(place, uint64_t{size - xml});
        logical.replace(24, place.size(), place);
    }
    std::string bytes = testing::with_checksums(logical);
    if (size % 4 == 3) {  // a page with a wrong checksum, which only `salvage` reads
        bytes[size / 4 % (bytes.size() / e57::kPageBytes) * e57::kPageBytes + e57::kPageBytes - 1] ^= 1;
        scan(bytes);
        bytes = testing::with_checksums(logical);
    }
    return scan(bytes);
}
