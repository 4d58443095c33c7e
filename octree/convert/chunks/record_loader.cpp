#include "octree/convert/chunks/record_loader.h"

#include <cassert>

#include <glm/geometric.hpp>

#include "octree/tree/attributes.h"

namespace lucarne::octree {
namespace {

constexpr double kFace = 1;  ///< areas are in faces of the root cube before it was doubled

}  // namespace

io::Schema with_estimates(io::Schema schema, bool normals) {
    if (normals) schema.add(std::string(io::names::normal_oct), io::ScalarType::u8, 3);
    schema.add(std::string(io::names::area), io::ScalarType::u16);
    schema.add(std::string(io::names::edge_line), io::ScalarType::u8, 2);
    const io::Attribute* color = schema.find(io::names::color);
    if (color && color->components == 3)
        schema.add(std::string(io::names::color_change), io::ScalarType::i8, 3);
    return schema;
}

RecordLoader::RecordLoader(const ChunkStore& chunks, const SurfaceStore* surface, bool normals,
                           std::span<const io::ScanInfo> scans)
    : chunks_(chunks),
      surface_(surface),
      schema_(surface && !chunks.schema().find(io::names::area)
                  ? with_estimates(chunks.points_schema(), normals)
                  : chunks.points_schema()),
      splats_(chunks_.points_schema()),
      drawn_normals_(schema_),
      normal_(schema_.find(io::names::normal_oct)),
      area_(schema_.find(io::names::area)),
      edge_(schema_.find(io::names::edge_line)) {
    if (surface)
        for (const io::ScanInfo& scan : scans) whites_.push_back(io::color_white(scan.color_bits));
}

PointEdge RecordLoader::drawn_edge(const SurfaceStore::Point& found, const std::byte* record) const {
    PointEdge edge = found.edge;
    if (glm::dot(drawn_normals_.of(record), found.normal) < 0) edge.beyond = turned(edge.beyond);
    return edge;
}

void RecordLoader::put_edge(const SurfaceStore::Point& found, std::byte* record) const {
    PointEdge edge = found.edge;
    if (edge.code != kNoEdge) {
        edge = drawn_edge(found, record);
        if (edge.beyond == Beyond::rises)
            edge.code = kNoEdge;
        else
            edge.code = rebased_edge(edge.code, {found.normal, found.area},
                                     {drawn_normals_.of(record), area(record)});
    }
    io::store(record + edge_->offset, edge.code);
}

Result<std::vector<std::byte>> RecordLoader::load(size_t chunk, uint64_t first, uint64_t count) const {
    LUCARNE_ASSIGN(auto input, chunks_.load(chunk, first, count));
    if (!surface_) {
        assert(chunks_.schema().stride == schema_.stride);  // only the search for normals uses stations
        return input;
    }
    LUCARNE_ASSIGN(const auto found, surface_->load(chunk, first, count));
    assert(area_ && found.size() == count);
    const uint32_t stride = chunks_.schema().stride, kept = chunks_.points_schema().stride;
    const bool in_place = kept == schema_.stride;
    std::vector<std::byte> records(count * schema_.stride);
    const double face = root().first_size() * root().first_size();
    for (size_t i = 0; i < count; ++i) {
        std::byte* record = &records[i * schema_.stride];
        std::memcpy(record, &input[i * stride], kept);
        if (normal_ && (!in_place || io::load<NormalCode>(record + normal_->offset) == kNoNormal))
            io::store(record + normal_->offset, encode_normal(splats_.normal(record, found[i].normal)));
        const float share = found[i].edge.narrowed < 255 ? drawn_edge(found[i], record).kept() : 1;
        const float area = splats_.area(record, share * found[i].area, face);
        if (!in_place || area > 0) io::store(record + area_->offset, encode_area(area, kFace));
        if (edge_) put_edge(found[i], record);
    }
    return records;
}

float RecordLoader::area(const std::byte* record) const {
    if (!area_) return 0;
    return static_cast<float>(decode_area(io::load<uint16_t>(record + area_->offset), kFace));
}

}  // namespace lucarne::octree
