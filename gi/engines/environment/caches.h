#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/gather/gatherer.h"
#include "gi/host_frame.h"

namespace lucarne::gi::environment {

/// Light that was gathered at a place, for pixels about it.
struct Cache {
    glm::vec3 position{0.0f}, normal{0.0f, 0.0f, 1.0f};
    float reach = 0;  ///< m; pixels farther away do not use it
    LightByNormal light{};
    /// The same by direction, if a surface is glossy; else none. It is not shared with others about
    /// (smooth()).
    std::shared_ptr<const LightByDirection> by_direction{};
};

/// Caches by the tiles of the picture in which they may count.
class CacheTiles {
 public:
    /// `caches` must live as long as the tiles.
    CacheTiles(const CameraView& camera, std::span<const Cache> caches);

    struct Counting;
    /// Interpolates the light about a surface point from the caches about it (Harada 2014, section 3.5): each
    /// counts by how near it is and how much its normal agrees (Ward et al. 1988, with the smooth weights of
    /// Tabellion & Lamorlette 2004), and not at all if it is in front of the point's plane. A slope is
    /// fitted to their light, because their mean is wrong where all of them lie on one side of the point.
    /// `pixel`: where it is seen if nothing hides it; the nearest place in the picture counts. Nothing if no
    /// cache counts. `room`: scratch memory, so that whoever asks often can give it again.
    std::optional<LightByNormal> light_at(const SurfacePoint& at, const glm::vec2& pixel,
                                          std::vector<Counting>& room) const;
    /// Finds the caches that count there. Returns the sum of their weights; if it is not over kLeastWeight,
    /// light_at() finds nothing.
    float find(const SurfacePoint& at, const glm::vec2& pixel, std::vector<Counting>& found) const;
    static constexpr float kLeastWeight = 0.02f;

 private:
    /// What decides whether a cache counts, in the order in which it is asked for.
    struct Place {
        glm::vec3 position;
        float reach;
        glm::vec3 normal;
        uint32_t cache;  ///< its number
    };
    struct Range {
        uint32_t left = 0, right = 0, upper = 0, lower = 0;  ///< tiles; the last ones are not included
    };
    Range range_of(const CameraView& camera, const Cache& cache) const;
    static float weight_of(const Place& cache, const SurfacePoint& at);
    template <class Body>
    void for_each_tile(const Range& range, const Body& body) const;

    std::span<const Cache> caches_;
    uint32_t columns_, rows_;
    std::vector<size_t> starts_;  ///< of each tile's caches in places_, and the end
    std::vector<Place> places_;
};

/// A cache that counts for a point, and how much.
struct CacheTiles::Counting {
    uint32_t cache;
    float weight;
    glm::vec3 offset;  ///< from the point, m
};

/// Lets caches share their light with those about them, as pixels do, against the noise of their few rays.
/// `reaches`: how far each shares its own, m.
void smooth(const CameraView& camera, std::span<Cache> caches, std::span<const float> reaches);

/// Sets the `light` of these `pixels`: the mean radiance for their normals, W/(sr m^2), from the caches.
/// Returns those for which no cache counts; their light is left as it is.
std::vector<uint32_t> interpolate(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                                  std::span<const uint32_t> pixels, std::span<const Cache> caches,
                                  std::span<glm::vec4> light);

/// Sets the light of these pixels, which no cache counts for, to the mean of the other pixels of their tile
/// of the picture, or of the whole picture.
void fill_by_means(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                   std::span<const uint32_t> lonely, std::span<glm::vec4> light);

}  // namespace lucarne::gi::environment
