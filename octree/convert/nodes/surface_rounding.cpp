#include "octree/convert/nodes/surface_rounding.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "octree/tree/attributes.h"

namespace lucarne::octree {
namespace {

constexpr size_t kFewest = 64;  ///< fewer differences have no meaningful median

}  // namespace

SurfaceRounding::SurfaceRounding(const io::Attribute* normals, const io::Attribute* areas, uint32_t stride)
    : stride_(stride) {
    if (normals) normal_at_ = normals->offset;
    if (areas) area_at_ = areas->offset;
}

void SurfaceRounding::round(std::span<std::byte> records) {
    if (normal_at_) round_normals(records);
    if (area_at_) round_areas(records);
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
