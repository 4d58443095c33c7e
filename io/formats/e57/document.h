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

// What the XML section of an E57 file says (ASTM E2807-11, 8), as far as points need it.
namespace lucarne::io::e57 {

/// One element of a record: a bytestream of values of `bits` bits each.
struct Field {
    enum class Kind : uint8_t { f32, f64, integer, scaled, text };
    std::string name;  ///< with its prefix: "nor:normalX"
    Kind kind = Kind::f64;
    unsigned bits = 64;                ///< 0 for a constant; not for text
    int64_t minimum = 0, maximum = 0;  ///< integer and scaled: as declared
    double scale = 1.0, offset = 0.0;  ///< scaled: value = integer * scale + offset

    bool whole() const { return kind == Kind::integer || kind == Kind::scaled; }
    /// The largest integer that the bits can hold, which may be more than `maximum`.
    int64_t largest() const;
    bool operator==(const Field&) const = default;
};

/// From the scanner's own frame to the file's: rotation * p + translation.
struct Pose {
    glm::dmat3 rotation{1.0};
    glm::dvec3 translation{0.0};
    bool unturned = false;  ///< its rotation cannot be one and is left out
    bool moves() const { return rotation != glm::dmat3(1.0) || translation != glm::dvec3(0.0); }
};

struct Scan {
    std::string name, guid;
    uint64_t section = 0;  ///< physical offset of its CompressedVector
    uint64_t records = 0;
    std::vector<Field> fields;
    std::optional<Pose> pose;
    std::optional<std::array<double, 2>> intensity_limits;
    std::optional<double> color_maximum;  ///< the largest of the three limits
    /// The box of its points in its own frame, as the file states it, true or not: the least, the largest.
    std::optional<std::array<glm::dvec3, 2>> bounds;

    /// The index of the field `name`, none where there is none.
    std::optional<size_t> find(std::string_view name) const;
    /// All three, or none.
    std::optional<std::array<size_t, 3>> find(const std::array<std::string_view, 3>& names) const;
};

using Image = E57Notes::Image;

struct Document {
    std::string guid, library, coordinate_system;
    std::vector<Scan> scans;
    std::vector<Image> images;
};

/// `xml` is parsed in place. Errors: no well-formed XML, more than kMostTags tags or kMostScans scans,
/// elements that are missing or contradict themselves.
Result<Document> parse_document(const std::string& file, std::string& xml);

/// The scans with their fields, poses and limits, and the images; the first kMostListed of each.
E57Notes notes_of(const Document& document);

inline constexpr uint64_t kMostXmlBytes = uint64_t{32} << 20;
inline constexpr size_t kMostTags = size_t{1} << 21;  ///< bounds the tree, 64 bytes a node
inline constexpr size_t kMostScans = 65535;           ///< point_source_id has 16 bits, 0 is none
inline constexpr size_t kMostFields = 256;
inline constexpr size_t kMostListed = 1000;

}  // namespace lucarne::io::e57
