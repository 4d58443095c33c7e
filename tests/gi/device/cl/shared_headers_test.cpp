// The headers of gi/shared as OpenCL C: all of them compile, structs have the same layout as on the host, and
// functions return the same values.
#include <cmath>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gi/device/cl/cl_device.h"
#include "gi/shared/brdf.h"
#include "gi/shared/camera.h"
#include "gi/shared/clip.h"
#include "gi/shared/disc.h"
#include "gi/shared/edge.h"
#include "gi/shared/environment.h"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/frame.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/light.h"
#include "gi/shared/surfel_code.h"
#include "gi/shared/tone_curve.h"
#include "octree/tree/footprint.h"
#include "tests/gi/device/cl/on_opencl.h"

namespace lucarne::gi {
namespace {

/// Returns the embedded headers that OpenCL C shares: every one of gi/shared, and those of octree.
std::vector<std::string> shared_headers() {
    std::vector<std::string> headers = {"octree/tree/edge_turn.h", "octree/tree/footprint.h"};
    for (const ShaderText& text : shader_texts())
        if (text.path.starts_with("gi/shared/") && text.path.ends_with(".h")) headers.emplace_back(text.path);
    return headers;
}

class SharedHeadersInOpenCl : public OnOpenCl {
 protected:
    /// Compiles a text that includes these headers and returns its kernel `test`.
    Result<const ClKernel*> compile(const std::vector<std::string>& headers, const std::string& text) {
        std::string source;
        for (const std::string& header : headers) source += "#include \"" + header + "\"\n";
        source += text;
        const std::string name = "test" + std::to_string(++compiled_) + ".cl";
        device->add_shader(name, source);
        return opencl->kernel(name, "test");
    }

 private:
    int compiled_ = 0;
};

TEST_F(SharedHeadersInOpenCl, EachCompilesAlone) {
    const auto headers = shared_headers();
    EXPECT_GT(headers.size(), 10u);
    for (const std::string& header : headers) {
        const auto kernel = compile({header}, "kernel void test(global uint* out) { out[0] = 1u; }\n");
        EXPECT_TRUE(kernel) << kernel.error().line();
    }
}

TEST_F(SharedHeadersInOpenCl, StructsHaveTheSameLayoutAsOnTheHost) {
    std::set<std::string> compared = {"Reflectance", "ViewDisc", "DiscHit", "DiscPicture",
                                      "DiscBox"};  // no buffer holds any
    std::vector<uint32_t> expected;
    std::string text = "kernel void test(global uint* out) { uint i = 0; global char* start = 0;\n";
    const auto compare = [&](const std::string& type, const std::string& field, size_t size, size_t offset) {
        compared.insert(type);
        expected.insert(expected.end(), {static_cast<uint32_t>(size), static_cast<uint32_t>(offset)});
        text += "out[i++] = sizeof(" + type + "); out[i++] = (global char*)&((global " + type + "*)start)->" +
                field + " - start;\n";
    };
#define LUCARNE_COMPARE(type, field) compare(#type, #field, sizeof(type), offsetof(type, field))
    LUCARNE_COMPARE(CameraView, width);
    LUCARNE_COMPARE(ClipShape, kind);
    LUCARNE_COMPARE(CutBlock, lod);
    LUCARNE_COMPARE(CutItem, size);
    LUCARNE_COMPARE(CutItem, child);
    LUCARNE_COMPARE(FlatSurfel, edge_root);
    LUCARNE_COMPARE(GBufferTexel, material);
    LUCARNE_COMPARE(Light, extent);
    LUCARNE_COMPARE(Light, kind);
    LUCARNE_COMPARE(Material, emission);
    LUCARNE_COMPARE(PackedSurfel, d);
#undef LUCARNE_COMPARE
    static const std::regex definition("LUCARNE_STRUCT\\((\\w+)\\) \\{");
    for (const ShaderText& header : shader_texts()) {
        if (!header.path.starts_with("gi/shared/")) continue;
        const std::string all(header.text);
        for (std::sregex_iterator found(all.begin(), all.end(), definition), end; found != end; ++found)
            EXPECT_TRUE(compared.contains((*found)[1])) << (*found)[1] << " of " << header.path;
    }

    const auto kernel = compile(shared_headers(), text + "}\n");
    ASSERT_TRUE(kernel) << kernel.error().line();
    auto out = opencl->buffer(expected.size() * sizeof(uint32_t), "layouts");
    ASSERT_TRUE(out);
    ASSERT_TRUE((*kernel)->run(ClRange(1, 1), *out));
    std::vector<uint32_t> found(expected.size());
    ASSERT_TRUE(out->download(0, std::as_writable_bytes(std::span(found))));
    EXPECT_EQ(found, expected);
}

// Compiles a text here and keeps it as a string, for OpenCL.
#define LUCARNE_IN_BOTH(name, ...) __VA_ARGS__ constexpr const char* name = #__VA_ARGS__;

using octree::surfel_area, octree::surfel_radius;
// Each sample maps 16 numbers in [0, 1) to four results.
// clang-format off
LUCARNE_IN_BOTH(kSamplesText,
LUCARNE_CONST uint kSamples = 15u;

LUCARNE_FN vec3 rgb_of(vec4 v) { return vec3(v.x, v.y, v.z); }
LUCARNE_FN vec3 unit_of(vec4 v) { return normalize(rgb_of(v) - 0.5f); }
LUCARNE_FN vec4 with(vec3 v, float w) { return vec4(v.x, v.y, v.z, w); }
LUCARNE_FN uint bits_of(vec4 v) { return uint(v.x * 65535.0f) | uint(v.y * 65535.0f) << 16; }

LUCARNE_FN vec4 brdf_sample(vec4 a, vec4 b, vec4 c, vec4 d) {
    Material material;
    material.diffuse = a;
    material.emission = vec4(0.0f, 0.0f, 0.0f, 50.0f * b.w);
    Reflectance r = make_reflectance(material, rgb_of(b));
    return with(brdf(r, unit_of(c), unit_of(d), unit_of(vec4(d.w, d.z, c.w, 0.0f))), r.kd.x + r.ks + r.exponent);
}
LUCARNE_FN Light light_of(vec4 a, vec4 b) {
    Light light;
    light.position = with(4.0f * rgb_of(a), 0.3f);
    light.direction = with(unit_of(b), 0.3f + b.w);
    light.strength = vec4(1.0f, 2.0f, 3.0f, 0.0f);
    light.extent = with(normalize(cross(unit_of(b), vec3(0.0f, 0.0f, 1.0f))), 1.0f);
    uint kinds = uint(a.w * 4.0f);
    light.kind = kinds == 3u ? kCosineLight : kinds;
    light.nested = 4u;
    return light;
}
LUCARNE_FN vec4 irradiance_sample(vec4 a, vec4 b, vec4 c, vec4 d) {
    vec3 to_light = vec3(0.0f);
    vec3 light = light_irradiance(light_of(a, b), rgb_of(c), unit_of(d), LUCARNE_REF(to_light));
    return with(light, to_light.x);
}
LUCARNE_FN vec4 direction_sample(vec4 a, vec4 b, vec4 c, vec4 d) {
    vec3 to_light = vec3(0.0f);
    light_irradiance(light_of(a, b), rgb_of(c), unit_of(d), LUCARNE_REF(to_light));
    return with(to_light, float(light_face(light_of(a, b), rgb_of(c) - 0.5f)));
}
LUCARNE_FN vec4 octahedral_sample(vec4 a) {
    vec3 n = unit_of(a);
    return with(decode_octahedral(encode_octahedral(n)), dot(n, decode_octahedral(bits_of(a))));
}
LUCARNE_FN vec4 colour_sample(vec4 a) {
    return with(decode_albedo(bits_of(a) & ~kSurfelHasNormal), linear_to_srgb(a.x));
}
LUCARNE_FN vec4 surfel_sample(vec4 a, vec4 b) {
    uint x = bits_of(a);
    uint y = bits_of(b);
    return with(surfel_fractions(x, y), float(surfel_octant(x, y, uint(a.w * 16.0f))));
}
LUCARNE_FN vec4 size_sample(vec4 a, vec4 b) {
    uint code = bits_of(a);
    float own = surfel_own_area(code, 8.0f * b.x);
    return vec4(surfel_radius(own, 0.01f * b.y), surfel_area(own, 0.01f * b.y), float(surfel_material(code)),
                surfel_is_stray(code, bits_of(b)) ? 1.0f : 0.0f);
}
LUCARNE_FN vec4 clip_sample(vec4 a, vec4 b, vec4 c, vec4 d) {
    uint known = clip_fold(uint(d.x * 4.0f), rgb_of(d) - 0.5f, a * 2.0f - 1.0f, b * 2.0f - 1.0f,
                           c * 2.0f - 1.0f, float(uint(d.w * 3.0f)));
    return vec4(float(known), clip_kept(known) ? 1.0f : 0.0f, clip_place(rgb_of(a), b), 0.0f);
}
LUCARNE_FN vec4 screen_sample(vec4 a) {
    vec3 x = rgb_of(a) * 4.0f - 0.5f;
    return with(tone_curve(x, uint(a.w * 3.0f), a.w * 10.0f), luminance(x));
}
LUCARNE_FN vec4 environment_sample(vec4 a) {
    vec2 place = environment_place(unit_of(a), a.w);
    return vec4(place.x, place.y, cube_face(unit_of(a)) == 0u ? 1.0f : 0.0f, kPi);
}
LUCARNE_FN vec4 camera_sample(vec4 a, vec4 b, vec4 c) {
    CameraView view;
    view.origin = with(rgb_of(a), 0.01f);
    view.forward = with(unit_of(b), 0.0f);
    vec3 right = vec3(0.0f);
    vec3 up = vec3(0.0f);
    frame_about(unit_of(b), LUCARNE_REF(right), LUCARNE_REF(up));
    view.right = with(right, a.w - 0.5f);
    view.up = with(up, b.w - 0.5f);
    view.width = 64u;
    view.height = 48u;
    view.projection = c.w < 0.5f ? kPerspective : kOrthographic;
    vec2 at = 40.0f * vec2(c.x, c.y) + 1.0f;
    GBufferTexel texel;
    texel.depth = 1.0f + c.z;
    vec3 p = texel_position(view, at - 0.5f, texel) - toward_viewer(view, view_point(view, at, 2.0f));
    float depth = 0.0f;
    vec2 place = view_place(view, view_point(view, at, 1.0f + c.z), LUCARNE_REF(depth));
    return with(p + view_offset(view, at, depth), place.x * place.y + pixel_height(view, depth));
}
LUCARNE_FN vec4 texel_sample(vec4 a, vec4 b) {
    GBufferTexel texel;
    texel.normal = bits_of(a);
    texel.albedo = bits_of(b) & ~kSurfelHasNormal;
    texel.material = bits_of(vec4(b.z, b.w, 0.0f, 0.0f)) & 0x7bffffffu;
    return with(texel_normal(texel) + texel_albedo(texel), texel_radius(texel) + float(texel_material(texel)));
}
LUCARNE_FN ViewDisc disc_of(vec4 a, vec4 b) {
    ViewDisc disc;
    disc.centre = vec3(a.x - 0.5f, a.y - 0.5f, 2.0f + a.z);
    disc.normal = normalize(vec3(b.x - 0.5f, b.y - 0.5f, -1.0f));
    disc.radius = 0.1f + a.w;
    disc.extent = disc_reach(disc.radius, disc.normal.z);
    disc.push = kRimPush * disc.radius;
    disc.edge = vec3(4.0f * b.z, 0.0f, 4.0f * b.w);
    return disc;
}
LUCARNE_FN vec4 disc_sample(vec4 a, vec4 b, vec4 c) {
    ViewDisc disc = disc_of(a, b);
    vec3 ray = vec3(c.x - 0.5f, c.y - 0.5f, 1.0f);
    DiscHit hit = meet_disc(disc.centre, disc.normal, ray);
    uint key = disc_key(disc, vec3(0.0f), ray, 0.01f, true);
    return vec4(hit.t, hit.distance2, disc_depth(disc, vec3(0.0f), ray), uintBitsToFloat(key));
}
LUCARNE_FN vec4 edge_sample(vec4 a, vec4 b) {
    vec3 edge = edge_of_code(surfel_edge_code(bits_of(a), bits_of(b)), decode_octahedral(bits_of(a)), b.w);
    return with(edge, within_edge(edge, rgb_of(b)) ? 1.0f : 0.0f);
}
LUCARNE_FN vec4 range_sample(vec4 a, vec4 b) {
    ViewDisc disc = disc_of(a, b);
    vec2 x = disc_range(disc, disc.centre.x, disc.normal.x, false);
    vec2 y = disc_range(disc, disc.centre.y, disc.normal.y, true);
    return vec4(x.x, x.y, y.x, y.y);
}

LUCARNE_FN vec4 sample_of(uint which, vec4 a, vec4 b, vec4 c, vec4 d) {
    if (which == 0u) return brdf_sample(a, b, c, d);
    if (which == 1u) return irradiance_sample(a, b, c, d);
    if (which == 2u) return direction_sample(a, b, c, d);
    if (which == 3u) return octahedral_sample(a);
    if (which == 4u) return colour_sample(a);
    if (which == 5u) return surfel_sample(a, b);
    if (which == 6u) return size_sample(a, b);
    if (which == 7u) return clip_sample(a, b, c, d);
    if (which == 8u) return screen_sample(a);
    if (which == 9u) return environment_sample(a);
    if (which == 10u) return camera_sample(a, b, c);
    if (which == 11u) return texel_sample(a, b);
    if (which == 12u) return disc_sample(a, b, c);
    if (which == 13u) return edge_sample(a, b);
    return range_sample(a, b);
}
)
// clang-format on

constexpr const char* kSampleNames[] = {"brdf",   "irradiance", "direction", "octahedral", "colour",
                                        "surfel", "size",       "clip",      "screen",     "environment",
                                        "camera", "texel",      "disc",      "edge",       "range"};

TEST_F(SharedHeadersInOpenCl, FunctionsReturnTheValuesOfTheHost) {
    ASSERT_EQ(std::size(kSampleNames), kSamples);
    constexpr uint32_t kItems = 4096;
    std::vector<vec4> in(size_t{kItems} * 4);
    std::mt19937 random(7);
    for (vec4& v : in)
        for (int i = 0; i < 4; ++i) v[i] = static_cast<float>(random() >> 8) / 16777216.0f;

    const auto kernel = compile(shared_headers(), std::string(kSamplesText) + R"(
kernel void test(global const float4* in, uint items, global float4* out) {
    uint i = get_global_id(0);
    if (i >= items) return;
    for (uint which = 0; which < kSamples; ++which)
        out[i * kSamples + which] = sample_of(which, in[4 * i], in[4 * i + 1], in[4 * i + 2], in[4 * i + 3]);
}
)");
    ASSERT_TRUE(kernel) << kernel.error().line();
    auto from = opencl->buffer(in.size() * sizeof(vec4), "numbers");
    auto to = opencl->buffer(size_t{kItems} * kSamples * sizeof(vec4), "results");
    ASSERT_TRUE(from && to);
    ASSERT_TRUE(from->upload(0, std::as_bytes(std::span(in))));
    const auto ran = (*kernel)->run(ClRange(kItems, 64), *from, kItems, *to);
    ASSERT_TRUE(ran) << ran.error().line();
    std::vector<vec4> found(size_t{kItems} * kSamples);
    ASSERT_TRUE(to->download(0, std::as_writable_bytes(std::span(found))));

    std::vector<int> not_zero(kSamples);
    for (size_t i = 0; i < kItems; ++i)
        for (uint32_t which = 0; which < kSamples; ++which) {
            const vec4 expected = sample_of(which, in[4 * i], in[4 * i + 1], in[4 * i + 2], in[4 * i + 3]);
            const vec4 value = found[i * kSamples + which];
            not_zero[which] += expected.x != 0;
            for (int k = 0; k < 4; ++k)
                ASSERT_NEAR(value[k], expected[k], 2e-6 + 1e-5 * std::abs(expected[k]))
                    << kSampleNames[which] << " of item " << i << ", result " << k;
        }
    for (uint32_t which = 0; which < kSamples; ++which)
        EXPECT_GT(not_zero[which], 400) << kSampleNames[which] << " is hardly tested";
}

}  // namespace
}  // namespace lucarne::gi
