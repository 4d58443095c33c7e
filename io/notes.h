#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

// What a scan file says besides its points and besides what every format has (ScanInfo). A writer needs it to
// give the same format back, and `info` shows it. A cache keeps it as JSON text: io/formats/notes_json.h.
namespace lucarne::io {

enum class ScalarType : uint8_t;  // io/points.h

/// A variable length record of LAS, or an extended one.
struct LasRecord {
    std::string user_id;
    uint16_t record_id = 0;
    std::string description;
    bool extended = false;  ///< an EVLR: it follows the points
    std::vector<std::byte> data;

    bool is(std::string_view user, uint16_t record) const { return user_id == user && record_id == record; }
    std::string_view text() const { return {reinterpret_cast<const char*>(data.data()), data.size()}; }
    bool operator==(const LasRecord&) const = default;
};

/// The fields of a LAS header that are repeated in another file of the same points.
struct LasNotes {
    uint8_t minor = 2;  ///< the version is 1.<minor>
    uint16_t file_source_id = 0, global_encoding = 0;
    std::array<uint8_t, 16> guid{};
    std::string system_id, software;
    uint16_t creation_day = 0, creation_year = 0;
    uint8_t point_format = 0;
    uint16_t record_length = 20;
    glm::dvec3 scale{1.0}, offset{0.0};
    std::vector<LasRecord> vlrs;
    bool operator==(const LasNotes&) const = default;
};

struct PlyNotes {
    struct Property {
        std::string name;
        ScalarType type;
        bool operator==(const Property&) const = default;
    };
    std::vector<Property> properties;          ///< of the vertices, without list properties
    std::vector<std::string> comments, infos;  ///< the lines without "comment " and "obj_info "
    bool operator==(const PlyNotes&) const = default;
};

struct PcdNotes {
    uint64_t width = 0, height = 1;
    std::array<double, 7> viewpoint = {0, 0, 0, 1, 0, 0, 0};  ///< x, y, z, then a quaternion w, x, y, z
    bool operator==(const PcdNotes&) const = default;
};

/// The scans and images of an E57 file; of each the first e57::kMostListed.
struct E57Notes {
    struct Scan {
        std::string name, guid;
        uint64_t points = 0;
        std::vector<std::string> fields;
        std::optional<glm::dvec3> position;                 ///< translation of its pose
        std::optional<std::array<glm::dvec3, 3>> rotation;  ///< rotation of its pose, row by row
        std::optional<std::array<double, 2>> intensity_limits;
        std::optional<double> color_maximum;
        std::optional<glm::dvec3> stated_min, stated_max;  ///< in the scan's own frame; may be wrong
        bool operator==(const Scan&) const = default;
    };
    struct Image {
        std::string name, representation, encoding;  ///< for example "", "spherical", "jpeg"
        uint64_t bytes = 0, width = 0, height = 0;
        bool operator==(const Image&) const = default;
    };
    std::string guid, library, coordinate_system;  ///< the last is well-known text or any other text
    std::vector<Scan> scans;
    std::vector<Image> images;
    uint64_t image_count = 0;  ///< all images, listed or not
    bool operator==(const E57Notes&) const = default;
};

/// Counts of a mesh whose points are read.
struct MeshNotes {
    /// Only for a mesh whose surface was sampled.
    struct Samples {
        double area_m2 = 0, spacing_m = 0;
        uint64_t count = 0;             ///< approximate
        glm::dvec3 min{0.0}, max{0.0};  ///< box of the mesh, in the file's unit
        bool operator==(const Samples&) const = default;
    };
    uint64_t faces = 0, vertices = 0, triangles = 0, textures = 0;
    uint64_t without_area = 0, not_finite = 0;           ///< triangles that are left out
    uint64_t other_statements = 0, missing_corners = 0;  ///< only OBJ: see obj_reader.cpp
    std::optional<Samples> samples;
    bool operator==(const MeshNotes&) const = default;
};

/// The range of a scan's intensities.
struct IntensityLimits {
    double low = 0, high = 1;
    bool whole = false;  ///< the limits are integers, and are written as integers in JSON
    bool operator==(const IntensityLimits&) const = default;
};

struct FormatNotes {
    std::optional<LasNotes> las;
    /// Why the LAS header that a cache keeps cannot be written again; empty if it can.
    std::string las_damage;
    std::optional<PlyNotes> ply;
    std::optional<PcdNotes> pcd;
    std::optional<E57Notes> e57;
    std::optional<MeshNotes> mesh;
    std::optional<IntensityLimits> intensity_limits;
    /// The color bits of this file alone. ScanInfo::color_bits may be larger for a cache of several scans.
    std::optional<uint32_t> color_bits;

    // What merged_info finds out about several scans.
    std::optional<std::vector<LasRecord>>
        projection;  ///< records of the common coordinate system; empty if the systems differ
    std::optional<std::vector<LasRecord>>
        extras;                            ///< the record that describes the extra bytes of all LAS files
    std::string system_note, extras_note;  ///< what the user must know about these two

    bool operator==(const FormatNotes&) const = default;
};

}  // namespace lucarne::io
