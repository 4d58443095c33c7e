#include "octree/tree/filling.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "octree/tree/attributes.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kFinestLevel = 16;
constexpr double kCubeSpacings = 4096;  ///< edge of a cube
constexpr uint32_t kMostCubes = 256;

using Cubes = std::map<NodeKey, std::vector<uint32_t>>;

Cubes cubes_of(const SourceHeader& header, const NodeData& data, uint32_t level) {
    const io::Schema& schema = header.filling->schema;
    Cubes cubes;
    for (uint32_t i = 0; i < data.count; ++i)
        cubes[header.root.place(io::position_of(schema, &data.records[i * schema.stride])).key(level)]
            .push_back(i);
    return cubes;
}

/// The median share of the surfels, in squares of the unit; 0 if unknown.
double share_of(const SourceHeader& header, const NodeData& data) {
    const io::Schema& schema = header.filling->schema;
    const io::Attribute* area = schema.find(io::names::area);
    if (!area || area->type != io::ScalarType::u16 || data.count == 0) return 0;
    std::vector<uint16_t> codes(data.count);
    for (uint32_t i = 0; i < data.count; ++i)
        codes[i] = io::load<uint16_t>(&data.records[i * schema.stride + area->offset]);
    std::nth_element(codes.begin(), codes.begin() + data.count / 2, codes.end());
    return decode_area(codes[data.count / 2], header.root.first_size());
}

}  // namespace

io::Schema filling_schema(const Cube& root) {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(root.size * 0x1p-32);
    schema.offset = root.min + 0.5 * root.size;
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    schema.add(std::string(io::names::color), io::ScalarType::u8, 3);
    schema.add(std::string(io::names::normal_oct), io::ScalarType::u8, 3);
    schema.add(std::string(io::names::area), io::ScalarType::u16);
    return schema;
}

Filling grouped_filling(const SourceHeader& header, const NodeData& data) {
    Filling filling;
    filling.header.schema = header.filling->schema;
    filling.header.root = header.root;
    filling.header.min = header.min;
    filling.header.max = header.max;
    filling.header.points = data.count;
    filling.header.metres_per_unit = header.metres_per_unit;
    filling.header.scans.resize(1);
    filling.header.scans[0].color_bits = 8;
    const double share = share_of(header, data), spacing = std::sqrt(share) / header.root.size;
    uint32_t level = 0;
    while (level < kFinestLevel && std::ldexp(1.0, -static_cast<int>(level)) > kCubeSpacings * spacing)
        ++level;
    Cubes cubes = cubes_of(header, data, level);
    while (cubes.size() > kMostCubes) cubes = cubes_of(header, data, --level);
    const size_t stride = filling.header.schema.stride;
    for (const auto& [key, members] : cubes) {
        const auto count = static_cast<uint32_t>(members.size());
        NodeData& records = filling.records.emplace_back(NodeData{count, {}});
        records.records.reserve(members.size() * stride);
        for (const uint32_t i : members)
            records.records.insert(records.records.end(),
                                   data.records.begin() + static_cast<ptrdiff_t>(i * stride),
                                   data.records.begin() + static_cast<ptrdiff_t>((i + 1) * stride));
        NodeInfo node{.key = key, .count = count, .subtree_count = count};
        for (size_t i = 0; i < kPrefixSteps; ++i)
            node.area_floor[i] = static_cast<float>(std::min(std::ldexp(share, static_cast<int>(i)), 1e37));
        filling.nodes.push_back(node);
    }
    return filling;
}

}  // namespace lucarne::octree
