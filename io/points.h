#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"
#include "io/notes.h"

namespace lucarne::io {

/// The types of attribute values. The numbers are part of the cache format (octree/FORMAT.md).
enum class ScalarType : uint8_t {
    u8 = 1,
    i8 = 2,
    u16 = 3,
    i16 = 4,
    u32 = 5,
    i32 = 6,
    u64 = 7,
    i64 = 8,
    f32 = 9,
    f64 = 10
};
constexpr size_t scalar_bytes(ScalarType type) {
    constexpr std::array<uint8_t, 11> kBytes = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kBytes[static_cast<size_t>(type)];
}
std::string_view scalar_name(ScalarType type);  ///< "u8" ... "f64"
std::optional<ScalarType> scalar_type(std::string_view name);

/// How a record stores its three coordinates: in the same way as the file did.
enum class PositionType : uint8_t {
    i32_scaled = 1,  ///< LAS: x = integer * scale + offset
    f32 = 2,
    f64 = 3,
};
constexpr size_t position_bytes(PositionType type) {
    return type == PositionType::f64 ? 24 : 12;
}

struct Attribute {
    std::string name;
    ScalarType type = ScalarType::u8;
    uint32_t components = 1;
    uint32_t offset = 0;  ///< bytes from the start of the record
    size_t bytes() const { return scalar_bytes(type) * components; }
    bool operator==(const Attribute&) const = default;
};

/// Names that every folder agrees on. Formats may add other names.
namespace names {
inline constexpr std::string_view color = "color";    ///< u8, u16 or f32 x3, sRGB; see color_white
inline constexpr std::string_view normal = "normal";  ///< f32 or f64 x3, as in the file; (0,0,0) means none
inline constexpr std::string_view normal_oct =
    "normal_oct";                                 ///< u8 x3, estimated; see octree/tree/attributes.h
inline constexpr std::string_view area = "area";  ///< u16, share of surface at full resolution; as above
/// u8 x2: the line where a point's disc ends, at an outer edge or a border; see octree/tree/edge_line.h
inline constexpr std::string_view edge_line = "edge_line";
/// i8 x3: how the colour is changed when it is drawn; see octree/colours/even_colours.h
inline constexpr std::string_view color_change = "color_change";
/// Of Gaussian splats: f32 x3, the direction of the shortest axis, whose sign means nothing, or zero; and
/// f32, the radius of the disc that covers as much as the splat, in the file's unit.
inline constexpr std::string_view splat_axis = "splat_axis", splat_radius = "splat_radius";
inline constexpr std::string_view intensity = "intensity";
inline constexpr std::string_view classification = "classification";  ///< u8
inline constexpr std::string_view scan = "scan";  ///< u16: index of the input file, if there are several
// LAS fields, as the LAS specification defines them (flags: bit 0 synthetic, 1 key point, 2 withheld, 3
// overlap):
inline constexpr std::string_view return_number = "return_number";              // u8
inline constexpr std::string_view number_of_returns = "number_of_returns";      // u8
inline constexpr std::string_view scan_direction = "scan_direction";            // u8
inline constexpr std::string_view edge_of_flight_line = "edge_of_flight_line";  // u8
inline constexpr std::string_view class_flags = "class_flags";                  // u8
inline constexpr std::string_view scanner_channel = "scanner_channel";          // u8
inline constexpr std::string_view scan_angle_rank = "scan_angle_rank";          // i8, degrees (formats 0-3)
inline constexpr std::string_view scan_angle = "scan_angle";  // i16, 0.006 degrees (formats 6-8)
inline constexpr std::string_view user_data = "user_data";    // u8
inline constexpr std::string_view point_source_id =
    "point_source_id";                                    // u16; the station, if poses are known
inline constexpr std::string_view gps_time = "gps_time";  // f64
inline constexpr std::string_view nir = "nir";            // u16
}  // namespace names

/// The layout of one point record: first the position, then the attributes in order, without padding.
/// Little-endian both in memory and on disk.
struct Schema {
    PositionType position = PositionType::f64;
    glm::dvec3 scale{1.0}, offset{0.0};  ///< only for i32_scaled
    std::vector<Attribute> attributes;
    uint32_t stride = position_bytes(PositionType::f64);

    /// Appends an attribute after the last one. The stride grows by its size.
    void add(std::string name, ScalarType type, uint32_t components = 1);
    const Attribute* find(std::string_view name) const;
    bool operator==(const Schema&) const = default;
};

/// Consecutive records of `schema.stride` bytes each.
struct PointBatch {
    std::vector<std::byte> bytes;
    size_t count = 0;
};

template <class T>
T load(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}
template <class T>
void store(std::byte* at, T value) {
    std::memcpy(at, &value, sizeof value);
}

/// Returns the position of a record in world coordinates, in the file's own unit.
inline glm::dvec3 position_of(const Schema& schema, const std::byte* record) {
    switch (schema.position) {
        case PositionType::i32_scaled: {
            const glm::dvec3 integers(load<int32_t>(record), load<int32_t>(record + 4),
                                      load<int32_t>(record + 8));
            return integers * schema.scale + schema.offset;
        }
        case PositionType::f32:
            return {load<float>(record), load<float>(record + 4), load<float>(record + 8)};
        case PositionType::f64:
            break;
    }
    return {load<double>(record), load<double>(record + 8), load<double>(record + 16)};
}

/// Returns one component of an attribute as a double, whatever its type.
double scalar_at(ScalarType type, const std::byte* at);
void store_scalar(ScalarType type, std::byte* at, double value);  ///< rounds and clamps to the type's range

/// A place where a scanner stood, in the coordinates of the points. The points that it recorded have `id` as
/// their point_source_id.
struct Station {
    uint32_t id = 0;
    glm::dvec3 position{0.0};
};

/// Points or other parts of a file that are not among the points read from it, and why. `what` is a phrase
/// that follows the count: "points whose state is invalid".
struct Loss {
    std::string what;
    uint64_t count = 0;
    bool operator==(const Loss&) const = default;
};
using Losses = std::vector<Loss>;
/// Adds a loss. A count of 0 is ignored; counts of the same kind are summed.
void add_loss(Losses& losses, std::string_view what, uint64_t count);
void add_losses(Losses& losses, const Losses& more);
namespace lost {
inline constexpr std::string_view no_number = "points with a coordinate that is no number",
                                  cut_off = "points that are not there: the file ends before them",
                                  damaged = "points in damaged parts of the file",
                                  uncounted = "points that its header does not count",
                                  scan_header = "scans whose header is damaged or cut off";
}  // namespace lost

/// What is known about a scan besides its points.
struct ScanInfo {
    std::string path;
    std::string format;            ///< "LAS 1.2, point format 3"
    uint64_t declared_points = 0;  ///< by the header; the number that read() returns may differ
    uint64_t file_bytes = 0;       ///< with `modified` identifies the file's state; 0 if there is no file
    int64_t modified = 0;          ///< modification time of the file, ns since 1970
    double metres_per_unit = 1.0;
    bool unit_stated = false;  ///< by the file, its format or the user; otherwise metres are assumed
    /// How many bits of a component of `color` are in use: 8 or 16, or 0 for floats from 0 to 1. Many 16-bit
    /// fields hold only 0-255; the attribute itself stays as it was in the file.
    uint32_t color_bits = 8;
    std::vector<Station> stations;
    FormatNotes notes;              ///< what export needs to write the same format again
    std::string coordinate_system;  ///< its name, as in the file; empty if the file has none
    uint32_t epsg = 0;              ///< its EPSG code; 0 if the file has none
    /// The lowest and highest corner that the header of a LAS, LAZ, COPC or E57 file states, right or wrong.
    /// Not set for caches.
    std::optional<std::array<glm::dvec3, 2>> stated_box;
    Losses losses;  ///< known before the first pass; for a cache, everything that its build left out
};

/// Returns the value of a colour component at full intensity: 255, 65535, or 1 for 0 bits.
constexpr double color_white(uint32_t color_bits) {
    return color_bits == 0 ? 1.0 : color_bits <= 8 ? 255.0 : 65535.0;
}

/// One pass over a scan's points. Not thread-safe.
class PointReader {
 public:
    virtual ~PointReader() = default;
    /// Replaces `batch` by up to `most` points. Returns their number, 0 at the end. Drops points with a
    /// non-finite coordinate.
    virtual Result<size_t> read(PointBatch& batch, size_t most) = 0;
    virtual uint64_t dropped() const = 0;  ///< number so far; the caller of the pass reports it to the user
    /// Returns what the pass has left out so far, including dropped points. The losses in the scan's info
    /// come on top.
    virtual Losses losses() const;
};

/// A scan that can be read any number of times with bounded memory. It must outlive its readers.
class PointSource {
 public:
    virtual ~PointSource() = default;
    virtual const Schema& schema() const = 0;
    virtual const ScanInfo& info() const = 0;
    virtual Result<std::unique_ptr<PointReader>> open() const = 0;
    /// Returns whether pick() can reach any point without reading the points before it.
    virtual bool seekable() const { return false; }
    /// Replaces `batch` by the points with these indices, which must ascend and be below
    /// info().declared_points. Leaves out points with a non-finite coordinate. Thread-safe. Errors:
    /// unreadable; not seekable.
    virtual Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const;
    /// Returns the number of parts whose first points can be read without the points before them: the chunks
    /// of a LAZ file, the scans of an E57 file, pieces of a text file. At least 1.
    virtual size_t parts() const { return 1; }
    /// Replaces `batch` by the first points of a part, at most `most`; by fewer if the part has fewer.
    /// Thread-safe. Errors: unreadable.
    virtual Result<void> front(size_t part, size_t most, PointBatch& batch) const;
};

/// Appends the next points of a reader to `batch` until it has `most` points or the reader ends.
Result<void> read_up_to(PointReader& reader, const Schema& schema, size_t most, PointBatch& batch);

/// Writes batches of points. The records must have the schema that the writer was created for.
class PointWriter {
 public:
    virtual ~PointWriter() = default;
    virtual Result<void> write(std::span<const std::byte> records) = 0;  ///< whole records only
    virtual Result<void> finish() = 0;  ///< completes the header, syncs the file and gives it its name
};

}  // namespace lucarne::io
