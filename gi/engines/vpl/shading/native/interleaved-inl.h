// Lights the pixels of an interleaved picture by whatever lights it. Included once for each instruction set
// (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_INTERLEAVED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_INTERLEAVED_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_INTERLEAVED_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_INTERLEAVED_INL_H
#endif

#include <algorithm>
#include <vector>

#include "gi/engines/vpl/shading/native/interleaved.h"
#include "gi/engines/vpl/shading/native/surfaces-inl.h"
#include "gi/engines/vpl/shading/native/window.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// Lights pixels, some vectors at a time: those of one tile read the same map, which then stays in the cache.
///
/// `Lights` has
///     static constexpr size_t kTogether           this many vectors at a time
///     size_t count() const
///     Receivers receivers(const V3& position, const V3& normal, F radius) const   what light arrives at
///     void add(size_t number, const Receivers& to, Mask lanes, V3& sum) const     adds the light of one
template <class Lights>
class Batch {
 public:
    /// `surfaces` holds the rows of the picture from `first_row` on.
    Batch(const InterleavedPicture& picture, const Lights& lights, const Surfaces& surfaces, int first_row,
          glm::vec4* target)
        : picture_(picture), lights_(lights), surfaces_(surfaces), first_row_(first_row), target_(target) {}

    /// Adds the pixels at columns and rows of the picture. Each lane gets the light of the tiles in its mask,
    /// 0 for none.
    void add(hn::Vec<Ints> columns, hn::Vec<Ints> rows, U tiles) {
        const Ints di;
        const auto int_of = [&](size_t v) { return hn::Set(di, static_cast<int32_t>(v)); };
        const auto place = hn::Add(hn::Mul(hn::Sub(rows, hn::Set(di, first_row_)), int_of(surfaces_.stride)),
                                   hn::Add(columns, int_of(kBorder)));
        const auto plane = [&](const std::vector<float>& values) {
            return hn::GatherIndex(Floats(), values.data(), place);
        };
        const Mask shown = hn::Gt(plane(surfaces_.depth), hn::Zero(Floats()));
        tiles = hn::IfThenElseZero(hn::RebindMask(Words(), shown), tiles);
        if (hn::AllTrue(Words(), hn::Eq(tiles, hn::Zero(Words())))) return;
        const F zero = hn::Zero(Floats());
        to_[count_] = lights_.receivers({plane(surfaces_.x), plane(surfaces_.y), plane(surfaces_.z)},
                                        {plane(surfaces_.nx), plane(surfaces_.ny), plane(surfaces_.nz)},
                                        plane(surfaces_.radius));
        tiles_[count_] = tiles;
        pixels_[count_] = hn::Add(hn::Mul(rows, int_of(picture_.camera.width)), columns);
        sum_[count_] = {zero, zero, zero};
        if (++count_ == kMost) shade();
    }
    /// Shades the pixels that were added last; call once at the end.
    void shade() {
        for (int tile = 0; tile < picture_.n * picture_.n; ++tile) gather_tile(tile);
        for (size_t i = 0; i < count_; ++i) add_light(i);
        count_ = 0;
    }

 private:
    static constexpr size_t kMost = Lights::kTogether;

    void gather_tile(int tile) {
        Mask lanes[kMost];
        size_t which[kMost], used = 0;
        for (size_t i = 0; i < count_; ++i) {
            lanes[used] = hn::RebindMask(Floats(), hn::TestBit(tiles_[i], word(1u << tile)));
            which[used] = i;
            used += !hn::AllFalse(Floats(), lanes[used]);
        }
        if (!used) return;
        const auto step = static_cast<size_t>(picture_.n * picture_.n);
        for (auto light = static_cast<size_t>(tile); light < lights_.count(); light += step)
            for (size_t i = 0; i < used; ++i) lights_.add(light, to_[which[i]], lanes[i], sum_[which[i]]);
    }
    void add_light(size_t i) {
        // Each tile alone estimates the whole light.
        const F tiles = set(static_cast<float>(picture_.n * picture_.n));
        alignas(64) float lanes[3][kLanes];
        alignas(64) int32_t pixels[kLanes];
        alignas(64) uint32_t masks[kLanes];
        hn::Store(mul(sum_[i].x, tiles), Floats(), lanes[0]);
        hn::Store(mul(sum_[i].y, tiles), Floats(), lanes[1]);
        hn::Store(mul(sum_[i].z, tiles), Floats(), lanes[2]);
        hn::Store(pixels_[i], Ints(), pixels);
        hn::Store(tiles_[i], Words(), masks);
        for (size_t lane = 0; lane < hn::Lanes(Floats()); ++lane)
            if (masks[lane])
                target_[pixels[lane]] += glm::vec4(lanes[0][lane], lanes[1][lane], lanes[2][lane], 0);
    }

    const InterleavedPicture& picture_;
    const Lights& lights_;
    const Surfaces& surfaces_;
    int first_row_;
    glm::vec4* target_;
    size_t count_ = 0;
    typename Lights::Receivers to_[kMost];
    U tiles_[kMost];
    hn::Vec<Ints> pixels_[kMost];
    V3 sum_[kMost];
};

/// Lights the pixels of some rows by the lights of their tiles, tile after tile.
template <class Lights>
void light_pixels(const InterleavedPicture& picture, int first, int end, Batch<Lights>& batch) {
    const Ints di;
    const auto width = static_cast<int>(picture.camera.width);
    const auto columns = hn::Mul(hn::Iota(di, 0), hn::Set(di, picture.n));
    const auto last = hn::Set(di, width - 1);
    // Down before across: pixels close to each other read few texels of a map.
    for (int tile = 0; tile < picture.n * picture.n; ++tile)
        for (int x = tile % picture.n; x < width; x += picture.n * static_cast<int>(hn::Lanes(Floats())))
            for (int y = first; y < end; ++y) {
                if (y % picture.n != tile / picture.n) continue;
                const auto column = hn::Add(columns, hn::Set(di, x));
                const auto inside = hn::RebindMask(Words(), hn::Lt(column, hn::Set(di, width)));
                batch.add(hn::Min(column, last), hn::Set(di, y),
                          hn::IfThenElseZero(inside, word(1u << tile)));
            }
}

/// Lights the isolated pixels of some rows by the lights of the tiles that they lack.
template <class Lights>
void light_isolated(const InterleavedPicture& picture, int first, int end, Batch<Lights>& batch) {
    const uint32_t width = picture.camera.width;
    const auto begin =
                   std::ranges::lower_bound(picture.output.isolated, static_cast<uint32_t>(first) * width),
               stop = std::ranges::lower_bound(picture.output.isolated, static_cast<uint32_t>(end) * width);
    const auto lanes = static_cast<ptrdiff_t>(hn::Lanes(Floats()));
    for (auto at = begin; at < stop; at += std::min(lanes, stop - at)) {
        alignas(64) int32_t columns[kLanes] = {}, rows[kLanes];
        alignas(64) uint32_t lacking[kLanes] = {};
        std::ranges::fill(rows, first);
        for (ptrdiff_t lane = 0; lane < std::min(lanes, stop - at); ++lane) {
            columns[lane] = static_cast<int32_t>(at[lane] % width);
            rows[lane] = static_cast<int32_t>(at[lane] / width);
            lacking[lane] = lacking_tiles(picture.output.joints + 2 * size_t{at[lane]}, picture.n,
                                          columns[lane], rows[lane]);
        }
        batch.add(hn::Load(Ints(), columns), hn::Load(Ints(), rows), hn::Load(Words(), lacking));
    }
}

/// Adds the light of `lights` to the pixels of some rows.
template <class Lights>
void light_rows(const InterleavedPicture& picture, const Lights& lights, int first, int end) {
    Surfaces surfaces(picture.camera.width, static_cast<size_t>(end - first));
    for (int y = first; y < end; ++y)
        read_row(picture.camera, picture.pixels, y, static_cast<size_t>(y - first), surfaces);
    Batch<Lights> pixels(picture, lights, surfaces, first, picture.output.irradiance);
    light_pixels(picture, first, end, pixels);
    pixels.shade();
    if (picture.n == 1) return;
    Batch<Lights> isolated(picture, lights, surfaces, first, picture.output.own_irradiance);
    light_isolated(picture, first, end, isolated);
    isolated.shade();
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
