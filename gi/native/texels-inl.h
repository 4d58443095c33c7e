// gbuffer.h and camera.h for vectors of texels: decodes them and computes the rays of a view. The formulas
// stand a second time here because vectors have no operators on all instruction sets, and because they share
// divisions; a test compares both (tests/gi/native/vectors_test.cpp). Included once for each instruction set
// (Highway's foreach_target.h).
#if defined(LUCARNE_GI_NATIVE_TEXELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_NATIVE_TEXELS_INL_H
#undef LUCARNE_GI_NATIVE_TEXELS_INL_H
#else
#define LUCARNE_GI_NATIVE_TEXELS_INL_H
#endif

#include <cstring>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/native/reflectance.h"
#include "gi/native/vectors-inl.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

constexpr int kLanes = HWY_MAX_BYTES / 4;

/// Texels of a row, as many as a vector has lanes.
struct TexelWords {
    U depth, normal, albedo, material;
};
/// Reads `count` texels from 1 on; further lanes are 0.
HWY_INLINE TexelWords load_texels(const GBufferTexel* texels, int count) {
    alignas(64) GBufferTexel lanes[kLanes] = {};
    std::memcpy(
        lanes, texels,
        sizeof(GBufferTexel) * static_cast<size_t>(HWY_MIN(count, static_cast<int>(hn::Lanes(Floats())))));
    TexelWords words;
    hn::LoadInterleaved4(Words(), reinterpret_cast<const uint32_t*>(lanes), words.depth, words.normal,
                         words.albedo, words.material);
    return words;
}

/// Reads `count` vec4 from 1 on; further lanes are 0.
HWY_INLINE void load_vec4(const glm::vec4* from, int count, V3& xyz, F& w) {
    const Floats df;
    if (count >= static_cast<int>(hn::Lanes(df))) {
        hn::LoadInterleaved4(df, &from->x, xyz.x, xyz.y, xyz.z, w);
        return;
    }
    alignas(64) float lanes[4 * kLanes] = {};
    std::memcpy(lanes, from, sizeof(glm::vec4) * static_cast<size_t>(count));
    hn::LoadInterleaved4(df, lanes, xyz.x, xyz.y, xyz.z, w);
}
/// Writes the first `count` lanes, or all if it is larger.
HWY_INLINE void store_vec4(const V3& xyz, F w, int count, glm::vec4* to) {
    const Floats df;
    if (count >= static_cast<int>(hn::Lanes(df))) {
        hn::StoreInterleaved4(xyz.x, xyz.y, xyz.z, w, df, &to->x);
        return;
    }
    alignas(64) float lanes[4 * kLanes];
    hn::StoreInterleaved4(xyz.x, xyz.y, xyz.z, w, df, lanes);
    std::memcpy(to, lanes, sizeof(glm::vec4) * static_cast<size_t>(count));
}

/// view_across(). `column` and `row` are those of a picture point (middles of pixels at .5) plus the shift of
/// the view.
HWY_INLINE V3 view_across(const CameraView& view, F column, F row) {
    const F one = set(1.0f), two = set(2.0f);
    const F across = sub(over(mul(two, column), set(static_cast<float>(view.width))), one);
    const F down = sub(over(mul(two, row), set(static_cast<float>(view.height))), one);
    const auto axis = [&](float right, float up) {
        return add(mul(set(right), across), mul(down, set(-up)));
    };
    return {axis(view.right.x, view.up.x), axis(view.right.y, view.up.y), axis(view.right.z, view.up.z)};
}
/// view_ray().
HWY_INLINE V3 view_ray(const CameraView& view, F column, F row) {
    if (view.projection == kOrthographic)
        return {set(view.forward.x), set(view.forward.y), set(view.forward.z)};
    const V3 across = view_across(view, column, row);
    return {add(set(view.forward.x), across.x), add(set(view.forward.y), across.y),
            add(set(view.forward.z), across.z)};
}
/// view_offset() for the same places.
HWY_INLINE V3 view_offset(const CameraView& view, F column, F row, F depth) {
    if (view.projection != kOrthographic) return scaled(view_ray(view, column, row), depth);
    const V3 across = view_across(view, column, row);
    return {add(across.x, mul(depth, set(view.forward.x))), add(across.y, mul(depth, set(view.forward.y))),
            add(across.z, mul(depth, set(view.forward.z)))};
}
/// The middles of the pixels from (x, y) on in a row, plus the shift of the view.
HWY_INLINE F view_columns(const CameraView& view, int x) {
    return add(hn::Iota(Floats(), static_cast<float>(x)), set(0.5f + view.right.w));
}
HWY_INLINE F view_row(const CameraView& view, int y) {
    return set(static_cast<float>(y) + 0.5f + view.up.w);
}

/// Where a view shows points: pixels (middles at .5), and depth along the forward axis, m.
struct Places {
    F x, y, depth;
};
/// view_place() of points relative to the view's origin.
HWY_INLINE Places view_places(const CameraView& view, const V3& offset) {
    const auto per_square = [](const glm::vec4& axis) {
        return 1 / glm::dot(glm::vec3(axis), glm::vec3(axis));
    };
    const F half = set(0.5f), depth = dot(offset, view.forward);
    F x = mul(dot(offset, view.right), set(per_square(view.right)));
    F y = mul(dot(offset, view.up), set(-per_square(view.up)));
    if (view.projection != kOrthographic) {
        const F per_depth = over(set(1.0f), depth);
        x = mul(x, per_depth);
        y = mul(y, per_depth);
    }
    const auto pixel = [&](F ndc, uint32_t size, float shift) {
        return sub(mul(add(mul(half, ndc), half), set(static_cast<float>(size))), set(shift));
    };
    return {pixel(x, view.width, view.right.w), pixel(y, view.height, view.up.w), depth};
}

/// pixel_height(), m.
HWY_INLINE F pixel_heights(const CameraView& view, F depth) {
    const F height = set(2 * glm::length(glm::vec3(view.up)) / static_cast<float>(view.height));
    return view.projection == kOrthographic ? height : mul(height, depth);
}

/// The radii of the surfels of texels, m.
HWY_INLINE F texel_radii(U material) {
    return half_value(hn::ShiftRight<16>(material));
}
/// The materials of texels. Surfels name one of LUCARNE_DEVICE_MATERIALS.
HWY_INLINE hn::Vec<Ints> texel_materials(U material) {
    return hn::BitCast(Ints(), hn::And(material, word(LUCARNE_DEVICE_MATERIALS - 1)));
}
/// The diffuse reflectance of texels, kd of make_reflectance().
HWY_INLINE V3 diffuse_reflectance(const DiffuseTables& tables, U albedo, U material) {
    const Floats df;
    const auto index = texel_materials(material);
    const F most = hn::GatherIndex(df, tables.most.data(), index);
    const auto channel = [&](U code, size_t i) {
        const F linear =
            hn::GatherIndex(df, tables.linear.data(), hn::BitCast(Ints(), hn::And(code, word(1023))));
        const F scaled_albedo = mul(linear, hn::GatherIndex(df, tables.scale[i].data(), index));
        return hn::Min(hn::Max(scaled_albedo, hn::Zero(df)), most);
    };
    return {channel(albedo, 0), channel(hn::ShiftRight<10>(albedo), 1),
            channel(hn::ShiftRight<20>(albedo), 2)};
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
