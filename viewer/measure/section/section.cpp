#include "viewer/measure/section/section.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "octree/tree/scan_number.h"

namespace lucarne::viewer {
namespace {

constexpr uint64_t kNodesAtOnce = 16;  ///< nodes read between two calls of `progress`

/// The slice's horizontal axes.
class Frame {
 public:
    explicit Frame(const Slice& slice)
        : from_(slice.from),
          half_(slice.thickness / 2),
          length_(std::hypot(slice.to.x - slice.from.x, slice.to.y - slice.from.y)),
          u_((slice.to.x - slice.from.x) / length_, (slice.to.y - slice.from.y) / length_) {}

    bool meets(const octree::Cube& cube) const {
        const double h = cube.size / 2, reach = h * (std::abs(u_.x) + std::abs(u_.y));
        const glm::dvec2 p = place(cube.min + h);
        return p.x >= -reach && p.x <= length_ + reach && std::abs(p.y) <= half_ + reach;
    }
    bool holds(const glm::dvec2& p) const { return p.x >= 0 && p.x <= length_ && std::abs(p.y) <= half_; }
    glm::dvec2 place(const glm::dvec3& p) const {  ///< returns (along, across)
        const glm::dvec2 d(p.x - from_.x, p.y - from_.y);
        return {d.x * u_.x + d.y * u_.y, d.y * u_.x - d.x * u_.y};
    }

 private:
    glm::dvec3 from_;
    double half_, length_;
    glm::dvec2 u_;
};

/// Returns the nodes that may intersect the slice, coarse levels first.
std::vector<uint32_t> nodes_in(const octree::NodeSource& source, const Frame& frame) {
    const auto nodes = source.nodes();
    std::vector<uint32_t> found = source.roots();
    std::erase_if(found, [&](uint32_t root) { return !frame.meets(source.cube(root)); });
    for (size_t i = 0; i < found.size(); ++i)
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[found[i]].child(octant);
                child != octree::kNoNode && frame.meets(source.cube(child)))
                found.push_back(child);
    std::ranges::sort(found, {}, [&](uint32_t n) { return std::pair(nodes[n].key.level, n); });
    return found;
}

class ColorReader {
 public:
    explicit ColorReader(const octree::SourceHeader& header)
        : color_(header.schema.find(io::names::color)), scan_(header.schema), scans_(header.scans) {
        if (color_ && color_->components != 3) color_ = nullptr;
    }
    std::array<uint8_t, 3> at(const std::byte* record) const {
        std::array<uint8_t, 3> rgb{200, 200, 200};
        const size_t scan = scan_.of(record);
        const double white = io::color_white(scan < scans_.size() ? scans_[scan].color_bits : 8);
        for (size_t c = 0; color_ && c < 3; ++c) {
            const double value =
                io::scalar_at(color_->type, record + color_->offset + c * io::scalar_bytes(color_->type));
            rgb[c] = static_cast<uint8_t>(std::clamp(value / white * 255, 0.0, 255.0));
        }
        return rgb;
    }

 private:
    const io::Attribute* color_;
    octree::ScanNumber scan_;
    std::span<const io::ScanInfo> scans_;
};

Result<void> add_node(const octree::NodeSource& source, uint32_t node, const Frame& frame, Section& section) {
    LUCARNE_ASSIGN(const octree::NodeData data, source.load(node));
    const octree::SourcePart part = source.part_of(node);
    const io::Schema& schema = part.header.schema;
    const ColorReader color(part.header);
    for (uint32_t i = 0; i < data.count; ++i) {
        const std::byte* record = &data.records[size_t{i} * schema.stride];
        const glm::dvec3 position = io::position_of(schema, record) * part.scale;
        const glm::dvec2 at = frame.place(position);
        if (frame.holds(at)) section.points.push_back({at.x, at.y, position.z, color.at(record), {node, i}});
    }
    return {};
}

void take_heights(Section& section) {
    const auto [low, high] = std::ranges::minmax_element(section.points, {}, &SectionPoint::height);
    if (section.points.empty()) return;
    section.lowest = low->height;
    section.highest = high->height;
}

}  // namespace

Result<Section> read_section(const octree::NodeSource& source, const Slice& slice, size_t most,
                             const std::function<bool(const Section&, bool)>& progress) {
    if (slice.from.x == slice.to.x && slice.from.y == slice.to.y)
        return bad_arguments("section", "its line has no length on the map", "choose two points apart");
    const Frame frame(slice);
    const std::vector<uint32_t> nodes = nodes_in(source, frame);
    Section section;
    section.slice = slice;
    section.nodes = nodes.size();
    size_t level_start = 0;  // index of the first point of the level being read
    for (size_t i = 0; i < nodes.size(); ++i) {
        LUCARNE_TRY(add_node(source, nodes[i], frame, section));
        ++section.nodes_read;
        if (section.points.size() > most) {
            // Drop a partial level, since it would be an uneven sample. Keep part of the first level, which
            // is better than nothing.
            section.points.resize(level_start ? level_start : most);
            take_heights(section);
            return section;
        }
        const bool level_done = i + 1 == nodes.size() ||
                                source.nodes()[nodes[i]].key.level != source.nodes()[nodes[i + 1]].key.level;
        if (level_done) {
            level_start = section.points.size();
            take_heights(section);
        }
        if ((level_done || i % kNodesAtOnce == 0) && !progress(section, level_done)) return section;
    }
    section.complete = true;
    return section;
}

}  // namespace lucarne::viewer
