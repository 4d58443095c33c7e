#include "octree/convert/nodes/surface_rounding.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "octree/tree/attributes.h"

namespace lucarne::octree {
namespace {

constexpr size_t kFewest = 64;  ///< fewer differences have no meaningful median

}  // namespace

SurfaceRounding::SurfaceRounding(const io::Schema& schema) : drawn_normals_(schema), stride_(schema.stride) {
    const auto at = [&](std::string_view name) -> std::optional<uint32_t> {
        if (const auto* found = schema.find(name)) return found->offset;
        return std::nullopt;
    };
    normal_at_ = at(io::names::normal_oct);
    area_at_ = at(io::names::area);
    edge_at_ = area_at_ ? at(io::names::edge_line) : std::nullopt;
}

void SurfaceRounding::round(std::span<std::byte> records) {
    const auto each_edge = [&](const auto& use) {
        if (!edge_at_) return;
        for (size_t at = 0; at < records.size(); at += stride_)
            if (io::load<EdgeCode>(&records[at + *edge_at_]) != kNoEdge) use(&records[at]);
    };
    bases_.clear();
    each_edge([&](const std::byte* record) { bases_.push_back(base_of(record)); });
    if (normal_at_) round_normals(records);
    if (area_at_) round_areas(records);
    auto before = bases_.cbegin();
    each_edge([&](std::byte* record) {
        const auto code = io::load<EdgeCode>(record + *edge_at_);
        io::store(record + *edge_at_, rebased_edge(code, *before++, base_of(record)));
    });
}

EdgeBase SurfaceRounding::base_of(const std::byte* record) const {
    return {drawn_normals_.of(record), decode_area(io::load<uint16_t>(record + *area_at_), 1)};
}

int SurfaceRounding::step(std::vector<uint32_t>& differences, int most) {
    if (differences.size() < kFewest) return 1;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    return std::min(most, static_cast<int>(std::bit_floor(std::max(1u, *middle))));
}

void SurfaceRounding::round_normals(std::span<std::byte> records) {
    const auto code = [&](size_t at) { return io::load<NormalCode>(&records[at + *normal_at_]); };
    const auto first = [](NormalCode c) { return c[0] | (c[1] & 0xf) << 8; };
    const auto second = [](NormalCode c) { return c[1] >> 4 | c[2] << 4; };
    differences_.clear();
    NormalCode before = kNoNormal;
    for (size_t at = 0; at < records.size(); at += stride_) {
        const NormalCode c = code(at);
        if (c != kNoNormal && before != kNoNormal) {
            differences_.push_back(static_cast<uint32_t>(std::abs(first(c) - first(before))));
            differences_.push_back(static_cast<uint32_t>(std::abs(second(c) - second(before))));
        }
        before = c;
    }
    const int grid = step(differences_, kMostRounding);
    for (size_t at = 0; at < records.size(); at += stride_)
        io::store(&records[at + *normal_at_], round_normal(code(at), grid));
}

void SurfaceRounding::round_areas(std::span<std::byte> records) {
    const auto code = [&](size_t at) { return io::load<uint16_t>(&records[at + *area_at_]); };
    differences_.clear();
    uint16_t before = kNoArea;
    for (size_t at = 0; at < records.size(); at += stride_) {
        const uint16_t c = code(at);
        if (c != kNoArea && before != kNoArea)
            differences_.push_back(static_cast<uint32_t>(std::abs(c - before)));
        before = c;
    }
    const int grid = step(differences_, kMostAreaRounding);
    for (size_t at = 0; at < records.size(); at += stride_)
        io::store(&records[at + *area_at_], round_area(code(at), grid));
}

}  // namespace lucarne::octree
