#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/lattice.h"
#include "io/points.h"

// The public header and the variable length records of LAS 1.0-1.5. Sources: ASPRS, "LAS Specification 1.4 -
// R15" (2019), "LAS Specification 1.5 - R00" (2025), and the specifications of 1.0 to 1.3.
namespace lucarne::io::las {

using Vlr = LasRecord;
inline constexpr std::string_view kSpecUser = "LASF_Spec", kProjectionUser = "LASF_Projection",
                                  kOurUser = "lucarne";
inline constexpr uint16_t kExtraBytesRecord = 4, kStationsRecord = 1;
inline constexpr uint16_t kGeoKeyRecord = 34735, kGeoDoublesRecord = 34736, kWktRecord = 2112;

struct Header : LasNotes {
    uint64_t points = 0;
    uint64_t points_offset = 0;      ///< in the file; only for reading
    bool compressed = false;         ///< LAZ: io/formats/las/laz; only for reading
    uint16_t wave_bytes = 0;         ///< wave packet bytes in each record, which are skipped; 0 for writing
    glm::dvec3 low{0.0}, high{0.0};  ///< the stated box, right or wrong; only for reading
    Losses losses;                   ///< found while reading; only for reading

    const Vlr* find(std::string_view user, uint16_t record) const;
};
/// Returns the bytes of a header of LAS 1.0-1.4. LAS 1.5 adds 18, which some of its writers leave out.
constexpr uint16_t header_bytes(uint8_t minor) {
    return minor >= 4 ? 375 : minor == 3 ? 235 : 227;
}
constexpr bool extended_format(uint8_t point_format) {
    return point_format >= 6;
}
/// Point formats 4, 5, 9 and 10 are other formats with a wave packet between the fields and the extra bytes.
/// Returns that other format; returns every other format unchanged.
constexpr uint8_t without_waves(uint8_t point_format) {
    constexpr std::array<uint8_t, 11> kSame = {0, 1, 2, 3, 1, 3, 6, 7, 8, 6, 8};
    return point_format < kSame.size() ? kSame[point_format] : point_format;
}
constexpr uint8_t with_waves(uint8_t point_format) {
    return point_format == 1 ? 4 : point_format == 3 ? 5 : point_format == 6 ? 9 : 10;
}
inline constexpr uint16_t kWavePacketBytes = 29;
/// Returns the bytes of a record before its extra bytes. 0 for unknown formats and formats with wave packets.
constexpr uint16_t record_bytes(uint8_t point_format) {
    constexpr std::array<uint16_t, 9> kBytes = {20, 28, 26, 34, 0, 0, 30, 36, 38};
    return point_format < kBytes.size() ? kBytes[point_format] : 0;
}
constexpr bool has_gps_time(uint8_t f) {
    return f == 1 || f == 3 || f >= 6;
}
constexpr bool has_color(uint8_t f) {
    return f == 2 || f == 3 || f == 7 || f == 8;
}

/// Reads everything before the points, and the extended records after them. Rejects what is not LAS of a
/// known point format, and files that cannot hold the points they promise. Leaves out, with a warning,
/// records that are broken or too large to keep (kMostRecordBytes in all). Warns of bytes that follow the
/// points and belong to nothing.
///
/// With `salvage` the points are those that are there, or of LAZ those that may be there, and the missing
/// ones count as a loss. Whole records that follow the last point and lie in the stated box are points as
/// well.
Result<Header> read_header(const ByteSource& file, bool salvage = false);

inline constexpr uint64_t kMostRecordBytes = uint64_t{64} << 20;
inline constexpr uint32_t kMostRecords = 100'000;
/// Even if nothing changes from point to point, LAZ's adaptive models take a hundredth of a bit for each
/// point (the changes: 128 symbols of 2^15; the bit counts of two differences: 33 symbols each).
inline constexpr uint64_t kMostPointsAByte = 1000;

/// Returns whether these are more points than compressed bytes can hold, or than real scans shrink to.
bool too_many_for(uint64_t compressed_bytes, uint64_t points, uint16_t record_length);

/// Returns the header to write for the points of a LAS file. The notes must have `las`. Errors: a cache's
/// notes are damaged.
Result<Header> header_of(const std::string& file, const FormatNotes& notes);
/// Returns the lattice of a scan's file; empty if it was not LAS.
std::optional<Lattice> lattice_of(const ScanInfo& scan);

}  // namespace lucarne::io::las
