#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "io/core/error.h"
#include "io/notes.h"

// The content of an E57 file's XML section (ASTM E2807-11, 8), as far as points need it.
namespace lucarne::io::e57 {

/// One element of a record: a bytestream of values of `bits` bits each.
struct Field {
    enum class Kind : uint8_t { f32, f64, integer, scaled, text };
    std::string name;  ///< with its namespace prefix: "nor:normalX"
    Kind kind = Kind::f64;
    unsigned bits = 64;                ///< 0 for a constant; unused for text
    int64_t minimum = 0, maximum = 0;  ///< as declared; for integer and scaled
    double scale = 1.0, offset = 0.0;  ///< for scaled: value = integer * scale + offset

    bool whole() const { return kind == Kind::integer || kind == Kind::scaled; }
    /// Returns the largest integer that the bits can hold. It may exceed `maximum`.
    int64_t largest() const;
    bool operator==(const Field&) const = default;
};

/// Maps the scanner's own frame to the file's: rotation * p + translation.
struct Pose {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation{0.0};
    bool unturned = false;  ///< the quaternion is no rotation, so it is ignored
    bool moves() const { return rotation != glm::dmat3(1.0) || translation != glm::dvec3(0.0); }
};

struct Scan {
    std::string name, guid;
    uint64_t section = 0;  ///< physical offset of its CompressedVector
    uint64_t records = 0;
    std::vector<Field> fields;
    std::optional<Pose> pose;
    std::optional<std::array<double, 2>> intensity_limits;
    std::optional<double> color_maximum;  ///< the largest of the three channel limits
    double largest_color = 0;             ///< largest colour component in a sample, if no limits are stated
    /// The lowest and highest corner of its points in its own frame, as the file states them, right or wrong.
    std::optional<std::array<glm::dvec3, 2>> bounds;

    bool states_color() const { return color_maximum && *color_maximum > 0; }
    /// Returns the index of the field `name`; nothing if there is none.
    std::optional<size_t> find(std::string_view name) const;
    /// Returns the indices of all three fields; nothing if one is missing.
    std::optional<std::array<size_t, 3>> find(const std::array<std::string_view, 3>& names) const;
};

using Image = E57Notes::Image;

struct Document {
    std::string guid, library, coordinate_system;
    std::vector<Scan> scans;
    std::vector<Image> images;
};

/// Parses `xml` in place. Errors: XML that is not well-formed, more than kMostTags tags or kMostScans scans,
/// missing elements, elements that contradict themselves.
Result<Document> parse_document(const std::string& file, std::string& xml);

/// Returns the scans with their fields, poses and limits, and the images; of each the first kMostListed.
E57Notes notes_of(const Document& document);

inline constexpr uint64_t kMostXmlBytes = uint64_t{32} << 20;
inline constexpr size_t kMostTags = size_t{1} << 21;  ///< bounds the tree: 64 bytes a node
inline constexpr size_t kMostScans = 65535;           ///< point_source_id has 16 bits, and 0 means none
inline constexpr size_t kMostFields = 256;
inline constexpr size_t kMostListed = 1000;

}  // namespace lucarne::io::e57
