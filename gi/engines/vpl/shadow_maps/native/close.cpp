#include "gi/engines/vpl/shadow_maps/native/close.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/shadow_maps/splats.h"
#include "gi/engines/vpl/shadow_maps/texel.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shadow_maps/native/close.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"

#ifndef LUCARNE_NATIVE_CLOSE_ONCE
#define LUCARNE_NATIVE_CLOSE_ONCE
namespace lucarne::gi::vpl::native {

/// Decides which fringes of a map are supported, supported() in close.comp.
class Support {
 public:
    Support(const CloseMemory& memory, const uint32_t* cores) : memory_(memory), cores_(cores) {}

    bool holds(const glm::ivec2& at, uint32_t own) const {
        const Fringe fringe{point(at, own), map_normal(own), map_distance(own), radius(own)};
        for (int axis = 0; axis < kSupportAxes; ++axis) {
            const glm::ivec2 step = support_axis(axis);
            if (continues(fringe, at, step) && continues(fringe, at, -step)) return true;
        }
        return false;
    }

 private:
    struct Fringe {
        glm::vec3 point, normal;
        float distance, radius;  ///< that of its splat
    };
    glm::vec2 centre(const glm::ivec2& at) const {
        return (2.0f * glm::vec2(at) + 1.0f) / static_cast<float>(memory_.side) - 1.0f;
    }
    glm::vec3 point(const glm::ivec2& at, uint32_t texel) const {
        const glm::vec2 uv = centre(at);
        const float square = glm::dot(uv, uv);
        return glm::vec3(2.0f * uv, 1 - square) * (map_distance(texel) / (1 + square));
    }
    float radius(uint32_t texel) const {
        return std::max(map_radius(texel), memory_.splat_angle * map_distance(texel));
    }
    bool continues(const Fringe& fringe, const glm::ivec2& at, const glm::ivec2& direction) const {
        for (int step = 1; step <= kSupportReach; ++step) {
            const glm::ivec2 other = at + step * direction;
            const glm::vec2 uv = centre(glm::max(other, glm::ivec2(0)));
            if (std::min(other.x, other.y) < 0 || glm::dot(uv, uv) >= 1 || goes_on(fringe, other))
                return true;
        }
        return false;
    }
    bool goes_on(const Fringe& fringe, const glm::ivec2& other) const {
        const uint32_t texel =
            cores_[static_cast<size_t>(other.y) * memory_.side + static_cast<size_t>(other.x)];
        if (texel == kNothing) return false;
        if (map_distance(texel) <= fringe.distance + 2 * fringe.radius) return true;
        const glm::vec3 offset = point(other, texel) - fringe.point;
        const float tolerance = kSheetTolerance * fringe.radius +
                                map_texel_angle(static_cast<float>(memory_.side)) * fringe.distance;
        return std::abs(glm::dot(fringe.normal, offset)) <= kNormalError * glm::length(offset) + tolerance;
    }

    const CloseMemory& memory_;
    const uint32_t* cores_;
};

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sides are multiples of 8, and those of the coarse level multiples of 4.
using Eight = hn::CappedTag<uint32_t, 8>;
using Four = hn::CappedTag<uint32_t, 4>;

/// sheet_end() of pyramid.glsl.
template <class D>
HWY_INLINE FloatsOf<D> sheet_ends(D d, hn::Vec<D> texels, float splat_angle) {
    const hn::RebindToFloat<D> df;
    const auto distance = map_distances(d, texels);
    const auto splat = hn::Max(map_radii(d, texels), hn::Mul(hn::Set(df, splat_angle), distance));
    return hn::Add(distance, hn::Mul(hn::Set(df, 2.0f), splat));
}
/// A texel at another distance than the one whose surface it shows.
template <class D>
HWY_INLINE hn::Vec<D> moved(D d, FloatsOf<D> distance, hn::Vec<D> texels) {
    return pack_map_texels(d, distances_within(d, distance), hn::And(texels, hn::Set(d, 0xffffu)));
}
template <class D>
HWY_INLINE hn::Mask<D> below(D d, hn::Vec<D> texels, uint32_t limit) {  // unsigned
    const auto least = hn::Set(d, limit - 1);
    return hn::Eq(hn::Min(texels, least), texels);
}

/// Replaces the fringe of a map by its completed texels, close.comp.
void close_map(const CloseMemory& memory, size_t first) {
    const Eight d;
    const uint32_t* cores = memory.cores + first;
    uint32_t* fringe = memory.fringe + first;
    const Support support(memory, cores);
    const auto side = static_cast<int>(memory.side);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; x += static_cast<int>(hn::Lanes(d))) {
            const size_t at = static_cast<size_t>(y) * memory.side + static_cast<size_t>(x);
            const auto core = hn::LoadU(d, cores + at), own = hn::LoadU(d, fringe + at);
            const auto nearer = hn::AndNot(hn::Eq(own, core), hn::Eq(hn::Min(own, core), own));
            uint8_t bits[8] = {};
            if (!hn::AllFalse(d, nearer)) hn::StoreMaskBits(d, nearer, bits);
            if (bits[0] == 0 && !memory.sources) {
                hn::StoreU(core, d, fringe + at);
                continue;
            }
            for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
                if (bits[0] >> lane & 1 && support.holds({x + static_cast<int>(lane), y}, fringe[at + lane]))
                    continue;
                fringe[at + lane] = cores[at + lane];
                if (memory.sources)
                    memory.fringe_sources[first + at + lane] = memory.sources[first + at + lane];
            }
        }
}

/// Computes the coarse level of a map, pull.comp.
void pull(const CloseMemory& memory, const uint32_t* texels, uint32_t* coarse) {
    const Four d;
    const hn::RebindToFloat<Four> df;
    const size_t side = memory.side, half = side / 2;
    const auto open = hn::Set(d, kOpen);
    for (size_t y = 0; y < half; ++y)
        for (size_t x = 0; x < half; x += hn::Lanes(d)) {
            hn::Vec<Four> child[4];
            hn::LoadInterleaved2(d, texels + 2 * y * side + 2 * x, child[0], child[1]);
            hn::LoadInterleaved2(d, texels + (2 * y + 1) * side + 2 * x, child[2], child[3]);
            const auto nearest = hn::Min(hn::Min(child[0], child[1]), hn::Min(child[2], child[3]));
            const auto deepest = sheet_ends(d, nearest, memory.splat_angle);
            auto sum = hn::Zero(df), support = hn::Zero(df);
            for (const auto& texel : child) {
                const auto distance = map_distances(d, texel);
                const auto counts =
                    hn::And(hn::RebindMask(df, below(d, texel, kOpen)), hn::Le(distance, deepest));
                sum = hn::Add(sum, hn::IfThenElseZero(counts, distance));
                support = hn::Add(support, hn::IfThenElseZero(counts, hn::Set(df, 1.0f)));
            }
            const auto enough = hn::RebindMask(d, hn::Ge(support, hn::Set(df, 3.0f)));
            const auto mean = moved(d, hn::Div(sum, hn::Max(support, hn::Set(df, 1.0f))), nearest);
            const auto value = hn::IfThenElse(enough, mean, open);
            hn::StoreU(hn::IfThenElse(below(d, nearest, kOpen), value, nearest), d, coarse + y * half + x);
        }
}

/// Fills the holes of a map from its coarse level, push.comp.
void push(const CloseMemory& memory, const uint32_t* coarse, uint32_t* texels) {
    const Eight d;
    const hn::RebindToSigned<Eight> di;
    const hn::RebindToFloat<Eight> df;
    const auto half = static_cast<int>(memory.side / 2);
    const auto one = hn::Set(di, 1), last = hn::Set(di, half - 1);
    const auto* from = reinterpret_cast<const int32_t*>(coarse);
    for (int y = 0; y < 2 * half; ++y) {
        const int row = y / 2 * half, other_row = std::clamp(y / 2 + 2 * (y & 1) - 1, 0, half - 1) * half;
        for (int x = 0; x < 2 * half; x += static_cast<int>(hn::Lanes(d))) {
            uint32_t* at = texels + static_cast<size_t>(y) * memory.side + static_cast<size_t>(x);
            const auto own = hn::LoadU(d, at);
            const auto column = hn::Iota(di, x), parent = hn::ShiftRight<1>(column);
            const auto texel = [&](int row_start, hn::Vec<decltype(di)> index) {
                return hn::BitCast(d, hn::GatherIndex(di, from + row_start, index));
            };
            auto nearest = texel(row, parent);
            const auto known = hn::And(
                below(d, own, kOpen),
                hn::RebindMask(d, hn::Le(map_distances(d, own), sheet_ends(d, nearest, memory.splat_angle))));
            auto fills = hn::AndNot(known, below(d, nearest, kOpen));
            fills = hn::AndNot(hn::Eq(own, hn::Set(d, kOpen)), fills);
            if (hn::AllFalse(d, fills)) continue;
            const auto beside = hn::Sub(hn::Add(parent, hn::ShiftLeft<1>(hn::And(column, one))), one);
            const auto other = hn::Min(hn::Max(beside, hn::Zero(di)), last);
            const hn::Vec<Eight> around[4] = {nearest, texel(row, other), texel(other_row, parent),
                                              texel(other_row, other)};
            constexpr float kWeights[4] = {9 / 16.0f, 3 / 16.0f, 3 / 16.0f, 1 / 16.0f};
            for (const auto& corner : around) nearest = hn::Min(nearest, corner);
            const auto deepest = sheet_ends(d, nearest, memory.splat_angle);
            auto mean = hn::Zero(df);
            for (size_t i = 0; i < 4; ++i) {
                const auto distance = map_distances(d, around[i]);
                fills = hn::And(
                    fills, hn::And(below(d, around[i], kOpen), hn::RebindMask(d, hn::Le(distance, deepest))));
                mean = hn::Add(mean, hn::Mul(hn::Set(df, kWeights[i]), distance));
            }
            hn::StoreU(hn::IfThenElse(fills, moved(d, mean, nearest), own), d, at);
        }
    }
}

void CloseMaps(const CloseMemory& memory, size_t begin, size_t end) {
    const size_t texels = size_t{memory.side} * memory.side;
    std::vector<uint32_t> coarse(texels / 4);
    for (size_t map = begin; map < end; ++map) {
        close_map(memory, map * texels);
        pull(memory, memory.fringe + map * texels, coarse.data());
        push(memory, coarse.data(), memory.fringe + map * texels);
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(CloseMaps);
void close_and_fill(const CloseMemory& memory) {
    parallel_ranges(memory.maps, 8, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(CloseMaps)(memory, first, end);
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
