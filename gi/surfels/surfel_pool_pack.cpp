// Converts a node's records to surfels for the device.
#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/vector_relational.hpp>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/colouring.h"
#include "gi/surfels/outliers.h"
#include "gi/surfels/point_colours.h"
#include "gi/surfels/surfel_edge.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/attributes.h"
#include "octree/tree/edge_line.h"
#include "octree/tree/point_normals.h"

namespace lucarne::gi {
namespace {

using io::Attribute;

/// Packs records of one layout. Attributes of an unexpected shape count as absent.
class Packer {
 public:
    Packer(const octree::SourceHeader& header, const octree::NodeInfo& node, const octree::NodeData& data,
           const Scene& scene, uint32_t first_scan, const BakedLight* baked)
        : header_(header),
          scene_(scene),
          cube_(header.root.of(node.key)),
          normals_(header.schema),
          colouring_(header.schema, scene.look, first_scan),
          baked_(scene.albedo.flatten > 0 ? baked : nullptr),
          colours_(header, cube_, data, scene.albedo.balance),
          cast_(scene.albedo.white / luminance(scene.albedo.white)) {
        area_ = find(io::names::area, 1);
        classification_ = find(io::names::classification, 1);
        scan_ = find(io::names::scan, 1);
        edge_ = find(io::names::edge_line, 2);
        if (edge_ && edge_->type != io::ScalarType::u8) edge_ = nullptr;
    }

    PackedSurfel pack(const std::byte* record) {
        const glm::dvec3 position = io::position_of(header_.schema, record);
        const uint32_t scan = scan_ ? static_cast<uint32_t>(scalar(scan_, record)) : 0;
        const glm::uvec3 at(fraction(position.x - cube_.min.x), fraction(position.y - cube_.min.y),
                            fraction(position.z - cube_.min.z));
        PackedSurfel surfel;
        surfel.a = at.x | at.y << 16;
        // A hidden point is stored as an outlier: it is not drawn and has no share of any surface.
        const bool hidden = is_hidden(record);
        surfel.b = at.z | (hidden ? kStrayArea : area(record)) << 16 | material(position, record, scan) << 24;
        const glm::vec3 n = hidden ? glm::vec3(0.0f) : normals_.of(record);
        const auto shown = colouring_.colour(record, position.z, scan, n);
        surfel.d = shown ? *shown : albedo(position, record);
        const bool has_normal = n != glm::vec3(0.0f);
        surfel.c = has_normal ? encode_octahedral(n) : 0u;
        if (has_normal) surfel.d |= kSurfelHasNormal;
        if (has_normal && edge_) put_edge(record, n, surfel);
        if (!hidden && surfel_is_stray(surfel.b, surfel.d)) outliers_.push_back(packed_);
        ++packed_;
        return surfel;
    }
    /// The packed records, by their numbers, that the converter found to be outliers.
    const std::vector<uint32_t>& outliers() const { return outliers_; }

 private:
    const Attribute* find(std::string_view name, uint32_t components) const {
        const Attribute* found = header_.schema.find(name);
        return found && found->components == components ? found : nullptr;
    }
    static double scalar(const Attribute* attribute, const std::byte* record) {
        return io::scalar_at(attribute->type, record + attribute->offset);
    }

    bool is_hidden(const std::byte* record) const {
        if (!classification_ || scene_.look.hidden_classes.none()) return false;
        const double number = scalar(classification_, record);
        return number >= 0 && number < 256 && scene_.look.hidden_classes[static_cast<size_t>(number)];
    }

    uint32_t fraction(double offset) const {
        const double steps = std::floor(offset / cube_.size * static_cast<double>(kFractionSteps));
        return steps > 0 ? static_cast<uint32_t>(std::min(steps, 65535.0)) : 0u;
    }

    /// Returns the point's share of the surface, in squares of the source's unit; 0 if unknown.
    double own_area(const std::byte* record) const {
        if (!area_ || area_->type != io::ScalarType::u16) return 0;
        return octree::decode_area(static_cast<uint16_t>(scalar(area_, record)), header_.root.first_size());
    }

    /// Returns the area code: eighths of an octave below the face of the node's cube; 2^(-1/8) is 9 %.
    uint32_t area(const std::byte* record) const {
        const double own = own_area(record);
        const double octaves = std::log2(cube_.size * cube_.size / own);
        if (!(own > 0) || !std::isfinite(octaves)) return kUnknownArea;
        return static_cast<uint32_t>(std::clamp(std::lround(octaves * 8), 0l, long{kUnknownArea} - 1));
    }

    void put_edge(const std::byte* record, const glm::vec3& normal, PackedSurfel& surfel) const {
        const auto line = octree::decode_edge(normal, io::load<octree::EdgeCode>(record + edge_->offset));
        if (line)
            pack_edge(line->toward,
                      line->distance * static_cast<float>(std::sqrt(own_area(record)) / cube_.size), surfel);
    }

    uint32_t material(const glm::dvec3& position, const std::byte* record, uint32_t scan) const {
        for (size_t i = std::min<size_t>(scene_.materials.size(), 256); i-- > 1;) {
            const SceneMaterial& m = scene_.materials[i];
            if (m.classification && !(classification_ && scalar(classification_, record) ==
                                                             static_cast<double>(*m.classification)))
                continue;
            if (m.scan && static_cast<int64_t>(scan) != *m.scan) continue;
            if (m.box && !(glm::all(glm::greaterThanEqual(position, m.box->first)) &&
                           glm::all(glm::lessThanEqual(position, m.box->second))))
                continue;
            return static_cast<uint32_t>(i);
        }
        return 0;
    }

    uint32_t albedo(const glm::dvec3& position, const std::byte* record) {
        constexpr double kDefault = 0.5;            // of a scan without colour, linear
        constexpr double kLargestFlattened = 0.95;  // as brdf.h caps it
        const auto own = colours_.of(record, position);
        glm::dvec3 srgb = own.value_or(glm::dvec3(linear_to_srgb(static_cast<float>(kDefault))));
        if (own && cast_ != glm::dvec3(1.0))
            for (int i = 0; i < 3; ++i) {
                const double linear = srgb_to_linear(static_cast<float>(srgb[i])) / cast_[i];
                srgb[i] = linear_to_srgb(static_cast<float>(std::min(linear, 1.0)));
            }
        if (own && baked_) {
            const double factor = baked_->factor(position, scene_.albedo.flatten);
            for (int i = 0; i < 3; ++i) {
                const double linear = factor * srgb_to_linear(static_cast<float>(srgb[i]));
                srgb[i] = linear_to_srgb(static_cast<float>(std::min(linear, kLargestFlattened)));
            }
        }
        return pack_colour(srgb);
    }

    const octree::SourceHeader& header_;
    const Scene& scene_;
    const octree::Cube cube_;
    const octree::PointNormals normals_;
    const Colouring colouring_;
    const BakedLight* const baked_;
    PointColours colours_;
    const glm::dvec3 cast_;  ///< of the scan's colours, linear, luminance 1
    const Attribute *area_, *classification_, *scan_, *edge_;
    uint32_t packed_ = 0;
    std::vector<uint32_t> outliers_;
};

/// The shares of a node add up to its surface. Where a hostile file claims more than a node can hold, all
/// shares shrink, so that the work of drawing a node stays bounded.
void limit_areas(std::vector<PackedSurfel>& surfels) {
    double sum = 0;  // in faces of the node's cube
    for (const PackedSurfel& s : surfels) sum += surfel_own_area(s.b, 1.0f);
    if (sum <= kMostSurface) return;
    const auto eighths = static_cast<uint32_t>(std::ceil(8 * std::log2(sum / kMostSurface)));
    for (PackedSurfel& s : surfels) {
        const uint32_t code = s.b >> 16 & 255u;
        if (code == kUnknownArea) continue;
        s.b = (s.b & 0xff00ffffu) | std::min(code + eighths, kUnknownArea - 1) << 16;
    }
}

}  // namespace

std::vector<PackedSurfel> pack_surfels(const octree::SourceHeader& header, const octree::NodeInfo& node,
                                       const octree::NodeData& data, const Scene& scene, uint32_t first_scan,
                                       const BakedLight* baked) {
    const size_t stride = header.schema.stride;
    assert(data.records.size() % stride == 0);
    std::vector<PackedSurfel> surfels(std::min<size_t>(data.count, data.records.size() / stride));
    Packer packer(header, node, data, scene, first_scan, baked);
    for (size_t i = 0; i < surfels.size(); ++i) surfels[i] = packer.pack(data.records.data() + i * stride);
    choose_outliers(scene.look.outliers, packer.outliers(), surfels);
    limit_areas(surfels);
    return surfels;
}

}  // namespace lucarne::gi
