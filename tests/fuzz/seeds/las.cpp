// Makes LAS of every version and point format by hand (tests/io/formats/las/las_builder.h), with and without
// everything that may stand beside the points.
#include <fmt/format.h>

#include "io/formats/las/header.h"
#include "tests/fuzz/seeds/seeds.h"
#include "tests/io/formats/las/las_builder.h"

namespace lucarne::fuzz {
namespace {

using namespace io::testing;

/// Returns three records whose bytes differ.
std::vector<std::string> records_of(size_t length) {
    std::vector<std::string> records(3, std::string(length, '\0'));
    for (size_t i = 0; i < records.size(); ++i)
        for (size_t b = 0; b < length; ++b)
            records[i][b] = static_cast<char>(b % 4 == 0 ? 17 * i + b : b % 3 == 0);
    return records;
}

/// Returns the bytes of a record of this point format, including wave packets.
size_t format_bytes(uint8_t format) {
    constexpr size_t kBytes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    return kBytes[format];
}

LasFile file_of(uint8_t minor, uint8_t format) {
    LasFile file;
    file.minor = minor;
    file.format = format;
    file.records = records_of(format_bytes(format));
    return file;
}

/// Extra bytes descriptors, both kinds of coordinate systems, stations, records after the points.
LasFile with_records() {
    LasFile file = file_of(4, 7);
    file.encoding = 1 << 4;
    for (std::string& record : file.records) record += std::string("\1\2\3\4\5\6\7", 7);
    file.add_vlr("LASF_Spec", 4, extra_descriptor(3, "height", 0x18) + extra_descriptor(9, "quality"));
    std::string keys;
    for (const int key : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 2056, 3076, 0, 1, 9003})
        append(keys, static_cast<uint16_t>(key));
    file.add_vlr("LASF_Projection", 34735, keys);
    file.add_vlr("LASF_Projection", 2112,
                 "PROJCS[\"a\",GEOGCS[\"b\",UNIT[\"degree\",0.0174532925]],UNIT[\"foot\",0.3048]]", true);
    file.add_vlr("lucarne", 1, R"({"stations":[{"id":1,"position":[1,2,3]}]})", true);
    return file;
}

}  // namespace

void las_seeds(const Seeds& seeds) {
    for (uint8_t format = 0; format <= 10; ++format) {
        const uint8_t minor = format >= 6 ? 4 : format >= 4 ? 3 : format >= 2 ? 2 : format;
        seeds.add_scan(fmt::format("format{}", format), file_of(minor, format).bytes());
    }
    seeds.add_scan("old-format-in-1.4", file_of(4, 3).bytes());
    seeds.add_scan("records", with_records().bytes());
}

}  // namespace lucarne::fuzz
