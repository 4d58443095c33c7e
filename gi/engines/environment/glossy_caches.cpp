#include "gi/engines/environment/glossy_caches.h"

#include <glm/geometric.hpp>

#include "gi/gather/final_gather.h"
#include "gi/gather/upsample.h"
#include "gi/lighting/direct_light.h"
#include "gi/lighting/lobe_albedo.h"
#include "gi/lighting/lobe_cells.h"
#include "io/core/parallel.h"

namespace lucarne::gi::environment {
namespace {

constexpr size_t kLobesAPiece = 1024;
/// A lobe that meets less than this of a ray has found nothing.
constexpr float kLeastRays = 1e-2f;

/// Finds the mean radiance that lobes of pixels reflect.
class LobeMeans {
 public:
    LobeMeans(const CameraView& camera, std::span<const Cache> caches, CachedLobes which,
              std::span<const SurfacePoint> surfaces, std::span<const Reflectance> reflectances,
              std::span<const glm::vec4> received)
        : camera_(camera),
          caches_(caches),
          tiles_(camera, caches),
          which_(which),
          surfaces_(surfaces),
          reflectances_(reflectances),
          received_(received) {}

    /// Returns for each of these pixels the mean radiance, and 1 in w if it was found.
    std::vector<glm::vec4> at(std::span<const uint32_t> pixels) const {
        std::vector<glm::vec4> means(pixels.size(), glm::vec4(0.0f));
        parallel_ranges(pixels.size(), kLobesAPiece, [&](size_t first, size_t last) {
            std::vector<CacheTiles::Counting> room;
            for (size_t i = first; i < last; ++i)
                if (surfaces_[pixels[i]].radius > 0) means[i] = mean_at(pixels[i], room);
        });
        return means;
    }

 private:
    glm::vec4 mean_at(uint32_t pixel, std::vector<CacheTiles::Counting>& room) const {
        const SurfacePoint& at = surfaces_[pixel];
        const glm::vec2 place(static_cast<float>(pixel % camera_.width),
                              static_cast<float>(pixel / camera_.width));
        glm::vec4 sum(0.0f);
        if (tiles_.find(at, place, room) > CacheTiles::kLeastWeight) {
            const LobeCells::Lobe lobe(reflectances_[pixel].exponent, at.normal, at.viewer);
            for (const CacheTiles::Counting& counting : room)
                if (const LightByDirection* light = caches_[counting.cache].by_direction.get())
                    add(*light, counting, lobe, sum);
        }
        if (sum.w > kLeastRays) return glm::vec4(glm::vec3(sum) / sum.w, 1);
        return which_ == CachedLobes::all ? glm::vec4(glm::vec3(received_[pixel]), 1) : glm::vec4(0.0f);
    }

    void add(const LightByDirection& light, const CacheTiles::Counting& counting, const LobeCells::Lobe& lobe,
             glm::vec4& sum) const {
        for (uint32_t i = 0; i < kDirectionCells; ++i) {
            const LightByDirection::Cell& cell = light.cells[i];
            if (!(cell.rays > 0)) continue;
            // From the pixel to what the cache sees there, in units of its distance from the cache. A cell is
            // too wide to tell where what is as near as the pixel itself lies, as in corners: it moves less.
            const glm::vec3 offset = cell.nearness / cell.rays * counting.offset;
            const glm::vec3 to = cells_.direction(i) + offset / (1 + glm::length(offset));
            const float weight = counting.weight * lobe.at(to);
            if (weight > 0) sum += weight * glm::vec4(cell.light, cell.rays);
        }
    }

    const CameraView& camera_;
    std::span<const Cache> caches_;
    CacheTiles tiles_;
    LobeCells cells_;
    CachedLobes which_;
    std::span<const SurfacePoint> surfaces_;
    std::span<const Reflectance> reflectances_;
    std::span<const glm::vec4> received_;
};

}  // namespace

void reflect_by_caches(const Frame& frame, std::span<const Cache> caches, CachedLobes which,
                       std::span<const Reflectance> reflectances, std::span<const glm::vec4> received,
                       std::span<SurfacePoint> surfaces, std::span<glm::vec4> light) {
    std::vector<SurfacePoint> cached(surfaces.begin(), surfaces.end());
    for (size_t i = 0; i < surfaces.size(); ++i) {
        if (!(reflectances[i].ks > 0)) surfaces[i].radius = 0;
        if (which == CachedLobes::wide && reflectances[i].exponent > LobeCells::kExactExponent)
            cached[i].radius = 0;
        cached[i].radius *= surfaces[i].radius > 0 ? 1.0f : 0.0f;
    }
    const LobeMeans means(frame.camera, caches, which, cached, reflectances, received);
    const GatherGrid grid = gather_grid(frame);
    std::vector<glm::vec4> found(surfaces.size());
    const auto missing = upsample(frame.camera, cached, grid, means.at(grid.pixels()), found);
    const auto alone = means.at(missing);
    for (size_t i = 0; i < missing.size(); ++i) found[missing[i]] = alone[i];
    LobeAlbedos albedos;
    albedos.take(device_materials(frame.materials));
    parallel_ranges(surfaces.size(), kLobesAPiece, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            // Between places with a mean and places without, most of it has to be from the former.
            if (!(cached[i].radius > 0) || !(found[i].w > 0.5f)) continue;
            surfaces[i].radius = 0;
            const Reflectance& r = reflectances[i];
            const float albedo =
                albedos.find(r.exponent)->at(glm::dot(surfaces[i].normal, surfaces[i].viewer));
            light[i] += r.ks * albedo * glm::vec4(glm::vec3(found[i]) / found[i].w, 0);
        }
    });
}

}  // namespace lucarne::gi::environment
