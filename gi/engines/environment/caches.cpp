#include "gi/engines/environment/caches.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "gi/shared/frame.h"
#include "io/core/parallel.h"

namespace lucarne::gi::environment {
namespace {

constexpr uint32_t kTileSide = 16;
constexpr size_t kPixelsAPiece = 4096, kCachesAPiece = 256;
/// Caches whose normals differ by more than about 26 degrees do not count.
constexpr float kLeastAgreement = 0.9f;
/// Offsets across a surface count as so many times those along it.
constexpr float kAcross = 4;
/// A cache is in front of a pixel's plane beyond this share of its reach.
constexpr float kInFront = 0.06f;
/// What a slope costs in LinearFit, in values of full weight at the end of their reach. With less, walls have
/// blotches along their edges.
constexpr float kFlatness = 0.1f;

/// Local linear regression over a plane (Fan 1992, "Design-adaptive nonparametric regression"): fits a value
/// at the origin and a slope to weighted values about it. A weighted mean is too low where all values lie on
/// the darker side, as on a floor at the foot of a sunlit wall.
class LinearFit {
 public:
    explicit LinearFit(const glm::vec3& normal) { frame_about(normal, right_, up_); }
    void add(const glm::vec3& offset, float reach, float weight) {
        if (!(scale_ > 0)) scale_ = 1 / reach;
        const glm::vec3 row = row_of(offset);
        sums_ += weight * glm::outerProduct(row, row);
        spread_ += weight * (reach * scale_) * (reach * scale_);
    }
    float weights() const { return sums_[0][0]; }
    /// Slopes cost a little (ridge regression), because one from few values would be their noise.
    void solve() {
        sums_[1][1] += kFlatness * spread_ / weights();
        sums_[2][2] += kFlatness * spread_ / weights();
        factors_ = glm::inverse(sums_)[0];
    }
    /// Returns by how much the weight of a value is to be multiplied, so that their sum is that at the
    /// origin.
    float factor(const glm::vec3& offset) const { return glm::dot(factors_, row_of(offset)); }

 private:
    glm::vec3 row_of(const glm::vec3& offset) const {
        return {1, scale_ * glm::dot(offset, right_), scale_ * glm::dot(offset, up_)};
    }

    float scale_ = 0;  ///< 1/m; with the first reach as unit, no scene is too small or too large for floats
    glm::vec3 right_, up_, factors_{0.0f};
    glm::mat3 sums_{0.0f};
    float spread_ = 0;
};

}  // namespace

/// Returns how much a cache counts for a surface point, 0 to 1.
float CacheTiles::weight_of(const Place& cache, const SurfacePoint& at) {
    const glm::vec3 offset = at.position - cache.position;
    const float distance2 = glm::dot(offset, offset), reach2 = cache.reach * cache.reach;
    if (distance2 >= reach2) return 0;
    const float agreement = glm::dot(cache.normal, at.normal);
    if (agreement <= kLeastAgreement) return 0;
    if (0.5f * glm::dot(offset, cache.normal + at.normal) < -kInFront * cache.reach - at.radius) return 0;
    const float across = glm::dot(offset, cache.normal);
    const float away = std::sqrt((distance2 + kAcross * kAcross * across * across) / reach2);
    const float turned = std::sqrt(std::max(1 - agreement, 0.0f) / (1 - kLeastAgreement));
    return std::max(1 - std::max(away, turned), 0.0f);
}

template <class Body>
void CacheTiles::for_each_tile(const Range& range, const Body& body) const {
    for (uint32_t row = range.upper; row < range.lower; ++row)
        for (uint32_t column = range.left; column < range.right; ++column)
            body(size_t{row} * columns_ + column);
}

CacheTiles::CacheTiles(const CameraView& camera, std::span<const Cache> caches)
    : caches_(caches),
      columns_((camera.width + kTileSide - 1) / kTileSide),
      rows_((camera.height + kTileSide - 1) / kTileSide) {
    std::vector<Range> ranges;
    starts_.assign(size_t{columns_} * rows_ + 1, 0);
    for (const Cache& cache : caches) {
        ranges.push_back(range_of(camera, cache));
        for_each_tile(ranges.back(), [&](size_t tile) { ++starts_[tile + 1]; });
    }
    for (size_t tile = 1; tile < starts_.size(); ++tile) starts_[tile] += starts_[tile - 1];
    places_.resize(starts_.back());
    std::vector<size_t> next(starts_.begin(), starts_.end() - 1);
    for (uint32_t i = 0; i < caches.size(); ++i)
        for_each_tile(ranges[i], [&](size_t tile) {
            places_[next[tile]++] = {caches[i].position, caches[i].reach, caches[i].normal, i};
        });
}

CacheTiles::Range CacheTiles::range_of(const CameraView& camera, const Cache& cache) const {
    float depth = 0;
    const glm::vec2 place = view_place(camera, cache.position, depth);
    if (!is_parallel(camera) && depth < 2 * cache.reach)
        return depth < -cache.reach ? Range{} : Range{0, columns_, 0, rows_};
    // Off the axis a sphere's picture is longer than on it, at most by this much.
    const float stretch = is_parallel(camera)
                              ? 1
                              : 1 + glm::dot(glm::vec3(camera.right), glm::vec3(camera.right)) +
                                    glm::dot(glm::vec3(camera.up), glm::vec3(camera.up));
    const float radius = cache.reach / pixel_height(camera, depth - cache.reach) * std::sqrt(stretch);
    if (!(place.x + radius >= 0 && place.y + radius >= 0)) return {};
    const auto tile = [](float at, uint32_t most) {
        return static_cast<uint32_t>(std::clamp(at / kTileSide, 0.0f, static_cast<float>(most)));
    };
    return {tile(place.x - radius, columns_), std::min(tile(place.x + radius, columns_) + 1, columns_),
            tile(place.y - radius, rows_), std::min(tile(place.y + radius, rows_) + 1, rows_)};
}

float CacheTiles::find(const SurfacePoint& at, const glm::vec2& pixel, std::vector<Counting>& found) const {
    const auto tile = [](float place, uint32_t count) {
        return static_cast<size_t>(std::clamp(place / kTileSide, 0.0f, static_cast<float>(count - 1)));
    };
    const size_t number = tile(pixel.y, rows_) * columns_ + tile(pixel.x, columns_);
    float sum = 0;
    found.clear();
    for (const Place& place :
         std::span(places_).subspan(starts_[number], starts_[number + 1] - starts_[number]))
        if (const float weight = weight_of(place, at); weight > 0) {
            found.push_back({place.cache, weight, place.position - at.position});
            sum += weight;
        }
    return sum;
}

std::optional<LightByNormal> CacheTiles::light_at(const SurfacePoint& at, const glm::vec2& pixel,
                                                  std::vector<Counting>& room) const {
    if (!(find(at, pixel, room) > kLeastWeight)) return std::nullopt;
    LinearFit fit(at.normal);
    for (const Counting& counting : room)
        fit.add(counting.offset, caches_[counting.cache].reach, counting.weight);
    fit.solve();
    LightByNormal sum{};
    for (const Counting& counting : room)
        sum.add(caches_[counting.cache].light, counting.weight * fit.factor(counting.offset));
    return sum;
}

void smooth(const CameraView& camera, std::span<Cache> caches, std::span<const float> reaches) {
    std::vector<Cache> wide(caches.begin(), caches.end());
    for (size_t i = 0; i < wide.size(); ++i) wide[i].reach = reaches[i];
    const CacheTiles tiles(camera, wide);
    parallel_ranges(caches.size(), kCachesAPiece, [&](size_t first, size_t last) {
        std::vector<CacheTiles::Counting> room;
        for (size_t i = first; i < last; ++i) {
            Cache& cache = caches[i];
            float depth = 0;
            const glm::vec2 pixel = view_place(camera, cache.position, depth);
            const auto shared =
                tiles.light_at({.position = cache.position, .normal = cache.normal}, pixel, room);
            if (shared) cache.light = *shared;
        }
    });
}

std::vector<uint32_t> interpolate(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                                  std::span<const uint32_t> pixels, std::span<const Cache> caches,
                                  std::span<glm::vec4> light) {
    const CacheTiles tiles(camera, caches);
    std::vector<std::vector<uint32_t>> lonely((pixels.size() + kPixelsAPiece - 1) / kPixelsAPiece);
    parallel_ranges(pixels.size(), kPixelsAPiece, [&](size_t first, size_t last) {
        std::vector<CacheTiles::Counting> room;
        for (size_t i = first; i < last; ++i) {
            const uint32_t pixel = pixels[i];
            const glm::vec2 at(static_cast<float>(pixel % camera.width),
                               static_cast<float>(pixel / camera.width));
            const auto found = tiles.light_at(surfaces[pixel], at, room);
            if (found)
                light[pixel] = glm::vec4(found->on(surfaces[pixel].normal), 0);
            else
                lonely[first / kPixelsAPiece].push_back(pixel);
        }
    });
    std::vector<uint32_t> all;
    for (const auto& piece : lonely) all.insert(all.end(), piece.begin(), piece.end());
    return all;
}

void fill_by_means(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                   std::span<const uint32_t> lonely, std::span<glm::vec4> light) {
    if (lonely.empty()) return;
    std::vector<bool> known(surfaces.size());
    for (size_t i = 0; i < surfaces.size(); ++i) known[i] = surfaces[i].radius > 0;
    for (const uint32_t pixel : lonely) known[pixel] = false;
    const uint32_t columns = (camera.width + kTileSide - 1) / kTileSide;
    const auto tile_of = [&](size_t pixel) {
        return pixel / camera.width / kTileSide * columns + pixel % camera.width / kTileSide;
    };
    std::vector<glm::dvec4> sums(size_t{columns} * ((camera.height + kTileSide - 1) / kTileSide));
    glm::dvec4 all(0.0);
    for (size_t i = 0; i < known.size(); ++i)
        if (known[i]) sums[tile_of(i)] += glm::dvec4(glm::dvec3(light[i]), 1);
    for (const glm::dvec4& sum : sums) all += sum;
    for (const uint32_t pixel : lonely) {
        const glm::dvec4& of_tile = sums[tile_of(pixel)];
        const glm::dvec4& sum = of_tile.w > 0 ? of_tile : all;
        light[pixel] = sum.w > 0 ? glm::vec4(glm::vec3(sum / sum.w), 0) : glm::vec4(0.0f);
    }
}

}  // namespace lucarne::gi::environment
