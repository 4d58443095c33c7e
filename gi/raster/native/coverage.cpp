#include "gi/raster/native/coverage.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>
#include <vector>

#include "gi/raster/coverage_code.h"
#include "gi/raster/one_surface.h"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/raster/native/coverage.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/texels-inl.h"
#include "gi/raster/native/disc-inl.h"

#ifndef LUCARNE_NATIVE_COVERAGE_ONCE
#define LUCARNE_NATIVE_COVERAGE_ONCE
namespace lucarne::gi::native {

using raster::kCoverageNeighbours, raster::kCoverageSamples;

/// Surfaces of pixels that show none, and of those outside the picture.
constexpr uint32_t kEmptySurface = UINT32_MAX, kOutside = UINT32_MAX - 1;

/// What decides whether neighbouring pixels show one surface, for a row: planes of a value for every pixel,
/// with a pixel to the left of the picture and a vector to the right.
class SurfaceRow {
 public:
    static constexpr size_t kMargin = 16;  // lanes
    explicit SurfaceRow(size_t width) : stride_(width + 2 * kMargin), planes_(kPlanes * stride_) {}

    enum Plane : size_t { px, py, pz, nx, ny, nz, reach, depth, surface, kPlanes };
    /// The value of pixel `x`, from -1 on.
    float* at(Plane plane, int x) {
        return planes_.data() + plane * stride_ + kMargin + static_cast<ptrdiff_t>(x);
    }
    const float* at(Plane plane, int x) const { return const_cast<SurfaceRow*>(this)->at(plane, x); }

 private:
    size_t stride_;
    std::vector<float> planes_;
};

/// A pixel with neighbours of other surfaces.
struct EdgePixel {
    int x;
    uint32_t others;  ///< a bit for each of them
    uint32_t behind;  ///< the one that shows where no disc is, or kCoverageNeighbours: its own
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

constexpr int kEdgeLanes = HWY_MAX_BYTES / 4;
static_assert(kEdgeLanes <= static_cast<int>(SurfaceRow::kMargin));

void mark_outside(SurfaceRow& row, int from, int to) {
    for (int x = from; x < to; ++x) *row.at(SurfaceRow::surface, x) = std::bit_cast<float>(kOutside);
}

/// Fills a row from its texels; rows outside the picture show nothing that counts.
void read_surfaces(const CoverageRows& rows, int y, SurfaceRow& row) {
    const Floats df;
    const CameraView& camera = rows.camera;
    const auto width = static_cast<int>(camera.width);
    if (y < 0 || y >= static_cast<int>(camera.height)) return mark_outside(row, -1, width + kEdgeLanes);
    const GBufferTexel* texels = rows.texels + static_cast<size_t>(y) * camera.width;
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const TexelWords t = load_texels(texels + x, width - x);
        const F depth = hn::BitCast(df, t.depth);
        const V3 place = view_offset(camera, view_columns(camera, x), view_row(camera, y), depth);
        V3 normal = decode_octahedral(t.normal);
        const Mask turned = hn::RebindMask(df, hn::TestBit(t.albedo, word(kTexelFromBehind)));
        normal = choose(turned, {hn::Neg(normal.x), hn::Neg(normal.y), hn::Neg(normal.z)}, normal);
        const U shown = hn::Or(hn::And(t.material, word(0xffffu)), hn::And(t.albedo, word(kSurfelHasNormal)));
        const U surface = hn::IfThenElse(hn::Eq(t.depth, word(0)), word(kEmptySurface), shown);
        const auto keep = [&](F value, SurfaceRow::Plane plane) { hn::StoreU(value, df, row.at(plane, x)); };
        keep(place.x, SurfaceRow::px);
        keep(place.y, SurfaceRow::py);
        keep(place.z, SurfaceRow::pz);
        keep(normal.x, SurfaceRow::nx);
        keep(normal.y, SurfaceRow::ny);
        keep(normal.z, SurfaceRow::nz);
        keep(texel_radii(t.material), SurfaceRow::reach);
        keep(depth, SurfaceRow::depth);
        keep(hn::BitCast(df, surface), SurfaceRow::surface);
    }
    mark_outside(row, -1, 0);
    mark_outside(row, width, width + kEdgeLanes);
}

/// Some pixels of a SurfaceRow.
struct SeenSurfaces {
    V3 place, normal;
    F reach, depth;
    U surface;
};
HWY_INLINE SeenSurfaces load_surfaces(const SurfaceRow& row, int x) {
    const auto load = [&](SurfaceRow::Plane plane) { return hn::LoadU(Floats(), row.at(plane, x)); };
    return {{load(SurfaceRow::px), load(SurfaceRow::py), load(SurfaceRow::pz)},
            {load(SurfaceRow::nx), load(SurfaceRow::ny), load(SurfaceRow::nz)},
            load(SurfaceRow::reach),
            load(SurfaceRow::depth),
            hn::BitCast(Words(), load(SurfaceRow::surface))};
}

/// differ() of coverage.comp.
HWY_INLINE Mask differ(const CameraView& camera, const SeenSurfaces& a, const SeenSurfaces& b) {
    const Floats df;
    const V3 across{sub(b.place.x, a.place.x), sub(b.place.y, a.place.y), sub(b.place.z, a.place.z)};
    const F reach = pixel_heights(camera, hn::Max(a.depth, b.depth));
    const F most = add(mul(set(raster::kSlab), hn::Max(a.reach, b.reach)), reach);
    const Mask one = hn::And(
        hn::Gt(dot(a.normal, b.normal), set(raster::kCosCrease)),
        hn::And(hn::Le(hn::Abs(dot(a.normal, across)), most), hn::Le(hn::Abs(dot(b.normal, across)), most)));
    const auto alike = hn::RebindMask(df, hn::Eq(a.surface, b.surface));
    const auto empty = hn::RebindMask(df, hn::Eq(a.surface, word(kEmptySurface)));
    const auto outside = hn::RebindMask(df, hn::Eq(b.surface, word(kOutside)));
    return hn::Not(hn::Or(outside, hn::And(alike, hn::Or(empty, one))));
}

/// Lists the pixels of the middle one of three rows that have neighbours of other surfaces.
void list_edges(const CameraView& camera, const SurfaceRow* const rows[3], std::vector<EdgePixel>& edges) {
    const Floats df;
    const Words du;
    const auto width = static_cast<int>(camera.width);
    const F zero = hn::Zero(df);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const SeenSurfaces own = load_surfaces(*rows[1], x);
        U others = hn::Zero(du), behind = word(kCoverageNeighbours);
        F deepest = own.depth;
        for (uint32_t i = 0; i < kCoverageNeighbours; ++i) {
            const glm::ivec2 step = raster::coverage_neighbour(i);
            const SeenSurfaces other = load_surfaces(*rows[1 + step.y], x + step.x);
            const Mask is_other = differ(camera, own, other);
            others = hn::Or(others, hn::IfThenElseZero(hn::RebindMask(du, is_other), word(1u << i)));
            const Mask deeper = hn::And(hn::And(is_other, hn::Ne(deepest, zero)),
                                        hn::Or(hn::Eq(other.depth, zero), hn::Gt(other.depth, deepest)));
            deepest = hn::IfThenElse(deeper, other.depth, deepest);
            behind = hn::IfThenElse(hn::RebindMask(du, deeper), word(i), behind);
        }
        if (hn::AllTrue(du, hn::Eq(others, hn::Zero(du)))) continue;
        alignas(64) uint32_t found[kEdgeLanes], last[kEdgeLanes];
        hn::Store(others, du, found);
        hn::Store(behind, du, last);
        for (int lane = 0; lane < std::min(static_cast<int>(hn::Lanes(df)), width - x); ++lane)
            if (found[lane]) edges.push_back({x + lane, found[lane], last[lane]});
    }
}

/// The samples of some pixels of a row: their rays, the order of the nearest disc, and which of the nine
/// pixels shows its surface.
struct CoverageSamples {
    alignas(64) float across[kCoverageSamples][kEdgeLanes];  ///< pixel_tangent()
    float down[kCoverageSamples];
    alignas(64) float nearest[kCoverageSamples][kEdgeLanes];
    alignas(64) uint32_t shown[kCoverageSamples][kEdgeLanes];
};

void place_samples(const DiscView& view, F x, int y, CoverageSamples& samples) {
    const Floats df;
    const F half = set(0.5f), one = set(1.0f), two = set(2.0f);
    for (uint32_t i = 0; i < kCoverageSamples; ++i) {
        const glm::vec2 at = raster::coverage_sample(i);
        const F moved = add(add(add(x, set(at.x)), half), set(view.shift.x));
        const F ndc = sub(over(mul(two, moved), set(static_cast<float>(view.width))), one);
        hn::Store(mul(ndc, set(view.right.w)), df, samples.across[i]);
        const float row = static_cast<float>(y) + at.y + 0.5f + view.shift.y;
        samples.down[i] = (2.0f * row / static_cast<float>(view.height) - 1.0f) * view.down.w;
        hn::Store(set(std::numeric_limits<float>::infinity()), df, samples.nearest[i]);
    }
}

/// Adds discs, one a lane, to the samples of the pixels at `x` in row `y`: add_disc() of coverage.comp.
HWY_INLINE void add_discs(const DiscView& view, const Discs& discs, Mask drawn, F x, int y, U shows,
                          CoverageSamples& samples) {
    const Floats df;
    const Words du;
    const F zero = hn::Zero(df), one = set(1.0f), half = set(0.5f);
    const bool flat = orthographic(view);
    const F scale = view_scale(view, discs.centre.z), near = set(view.forward.w);
    const auto place = [&](F along, F per, uint32_t size, float shift, F pixel) {
        const F middle = set(0.5f * static_cast<float>(size) - shift);
        return sub(sub(add(mul(over(along, scale), per), middle), half), pixel);
    };
    const F place_x = place(discs.centre.x, pixels_per_tangent_x(view), view.width, view.shift.x, x);
    const F place_y = place(discs.centre.y, pixels_per_tangent_y(view), view.height, view.shift.y,
                            set(static_cast<float>(y)));
    const Mask before = hn::Gt(discs.centre.z, near);
    const F r2 = mul(discs.radius, discs.radius), per_r2 = over(one, hn::Max(r2, set(1e-30f)));
    const F low = sub(discs.centre.z, discs.extent), high = add(discs.centre.z, discs.extent);
    F constant = dot(discs.normal, discs.centre);
    for (uint32_t i = 0; i < kCoverageSamples; ++i) {
        const glm::vec2 at = raster::coverage_sample(i);
        const F across = hn::Load(df, samples.across[i]), down = set(samples.down[i]);
        V3 ray{across, down, one}, centre = discs.centre;
        if (flat) {
            ray = {zero, zero, one};
            centre = {sub(centre.x, across), sub(centre.y, down), centre.z};
            constant = dot(discs.normal, centre);
        }
        // meet_disc() and disc_key().
        const F slope = dot(discs.normal, ray);
        const F facing = hn::IfThenElse(hn::Lt(hn::Abs(slope), set(1e-12f)), set(1e-12f), slope);
        const F t = over(constant, facing);
        const V3 offset{sub(mul(ray.x, t), centre.x), sub(mul(ray.y, t), centre.y), sub(t, centre.z)};
        const F distance2 = dot(offset, offset);
        const Mask inside = hn::And(hn::Le(distance2, r2), hn::Le(dot(discs.edge, offset), one));
        const F apart = hn::Max(hn::Abs(sub(place_x, set(at.x))), hn::Abs(sub(place_y, set(at.y))));
        const Mask covers = hn::Or(inside, hn::And(before, hn::Lt(apart, half)));
        const F z = hn::Min(hn::Max(t, low), high);
        const F key = add(z, mul(discs.push, hn::IfThenElse(inside, mul(distance2, per_r2), one)));
        const F held = hn::Load(df, samples.nearest[i]);
        const Mask takes = hn::And(hn::And(drawn, covers), hn::And(hn::Gt(z, near), hn::Lt(key, held)));
        hn::Store(hn::IfThenElse(takes, key, held), df, samples.nearest[i]);
        hn::Store(hn::IfThenElse(hn::RebindMask(du, takes), shows, hn::Load(du, samples.shown[i])), du,
                  samples.shown[i]);
    }
}

/// Finds the coverage of up to a vector of pixels of a row.
void cover(const CutMemory& cut, const CoverageRows& rows, int y, std::span<const EdgePixel> edges) {
    const Floats df;
    const Words du;
    const auto width = static_cast<int>(rows.view.width), height = static_cast<int>(rows.view.height);
    alignas(64) float column[kEdgeLanes] = {};
    alignas(64) uint32_t others[kEdgeLanes] = {}, ids[kEdgeLanes];
    CoverageSamples samples;
    for (size_t lane = 0; lane < edges.size(); ++lane) {
        column[lane] = static_cast<float>(edges[lane].x);
        others[lane] = edges[lane].others;
        for (uint32_t i = 0; i < kCoverageSamples; ++i) samples.shown[i][lane] = edges[lane].behind;
    }
    for (size_t lane = edges.size(); lane < hn::Lanes(df); ++lane)
        for (uint32_t i = 0; i < kCoverageSamples; ++i) samples.shown[i][lane] = kCoverageNeighbours;
    const U other = hn::Load(du, others);
    const F x = hn::Load(df, column);
    place_samples(rows.view, x, y, samples);
    for (uint32_t n = 0; n <= kCoverageNeighbours; ++n) {
        // The pixel itself comes first.
        const glm::ivec2 step = n == 0 ? glm::ivec2(0) : raster::coverage_neighbour(n - 1);
        std::ranges::fill(ids, kNoSurfel);
        const int row = y + step.y;
        if (row < 0 || row >= height) continue;
        for (size_t lane = 0; lane < edges.size(); ++lane) {
            const int at = edges[lane].x + step.x;
            if (at >= 0 && at < width)
                ids[lane] = rows.ids[static_cast<size_t>(row) * rows.view.width + static_cast<size_t>(at)];
        }
        const U id = hn::Load(du, ids);
        const auto taken = hn::Ne(id, word(kNoSurfel));
        if (hn::AllFalse(du, taken)) continue;
        const FoundSurfels found = find_surfels(cut, hn::IfThenElseZero(taken, id));
        Discs discs;
        Mask drawn = place_discs(rows.view, found.packed, found.origin, found.size, found.radius, discs);
        drawn = hn::And(drawn, turn_discs(rows.view, found.packed.c, found.packed.d, discs));
        drawn = hn::And(drawn, hn::RebindMask(df, taken));
        discs.edge = disc_edges(rows.view, found.packed.b, found.packed.c, found.packed.d, found.size);
        U shows = word(kCoverageNeighbours);
        if (n > 0) shows = hn::IfThenElse(hn::TestBit(other, word(1u << (n - 1))), word(n - 1), shows);
        add_discs(rows.view, discs, drawn, x, y, shows, samples);
    }
    uint32_t* coverage = rows.coverage + static_cast<size_t>(y) * rows.view.width;
    for (size_t lane = 0; lane < edges.size(); ++lane) {
        uint32_t code = 0;
        for (uint32_t i = 0; i < kCoverageSamples; ++i)
            if (const uint32_t shown = samples.shown[i][lane]; shown < kCoverageNeighbours)
                code += 1u << (4 * shown);
        coverage[edges[lane].x] = code;
    }
}

void FindCoverage(const CutMemory& cut, const CoverageRows& rows) {
    const size_t width = rows.view.width, lanes = hn::Lanes(Floats());
    std::vector<SurfaceRow> surfaces(3, SurfaceRow(width));
    std::vector<EdgePixel> edges;
    const auto row_of = [&](int y) -> SurfaceRow& { return surfaces[static_cast<size_t>(y + 3) % 3]; };
    read_surfaces(rows, rows.first - 1, row_of(rows.first - 1));
    read_surfaces(rows, rows.first, row_of(rows.first));
    for (int y = rows.first; y < rows.last; ++y) {
        read_surfaces(rows, y + 1, row_of(y + 1));
        const SurfaceRow* const three[3] = {&row_of(y - 1), &row_of(y), &row_of(y + 1)};
        edges.clear();
        list_edges(rows.camera, three, edges);
        std::fill_n(rows.coverage + static_cast<size_t>(y) * width, width, 0u);
        const std::span<const EdgePixel> all(edges);
        for (size_t at = 0; at < all.size(); at += lanes)
            cover(cut, rows, y, all.subspan(at, std::min(lanes, all.size() - at)));
    }
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(FindCoverage);
void find_coverage(const CutMemory& cut, const CoverageRows& rows) {
    HWY_DYNAMIC_DISPATCH(FindCoverage)(cut, rows);
}

}  // namespace lucarne::gi::native
#endif
