#pragma once

#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/volume/images/depth_tiles.h"
#include "gi/volume/images/image_voxels.h"

namespace lucarne::gi::volume {

/// What a picture shows at the place of a voxel.
enum class Sight : uint8_t {
    unknown,  ///< the voxel is behind what is visible, or outside the picture
    empty,    ///< something farther away is visible there
    surface,  ///< a surface in it is visible
};

/// Tells the sight of voxels with this side, m.
class VoxelSight {
 public:
    VoxelSight(const SeenImage& image, float voxel) : image_(image), half_(0.5f * voxel) {
        const CameraView& view = image.view;
        // The farthest corner of a voxel along the view axis (the thesis' bias b, equation 17, whose
        // listing 7.1 takes six times as much).
        const glm::vec3 along = glm::abs(xyz_of(view.forward));
        bias_ = half_ * (along.x + along.y + along.z);
        const auto scaled = [](const glm::vec3& axis, float pixels) {
            return axis * (0.5f * pixels / glm::dot(axis, axis));
        };
        size_ = glm::vec2(static_cast<float>(view.width), static_cast<float>(view.height));
        right_ = scaled(xyz_of(view.right), size_.x);
        down_ = -scaled(xyz_of(view.up), size_.y);
        centre_ = 0.5f * size_ - glm::vec2(view.right.w, view.up.w);
    }

    /// Tells the sight of a voxel about `middle`. Sets `pixel` unless it is unknown.
    Sight at(const glm::vec3& middle, size_t& pixel) const {
        glm::vec2 place;
        const float depth = project(middle, place);
        // A voxel beside or behind the viewer is in no picture; the comparisons are false for NaN, too.
        if (!(depth > image_.view.origin.w && shows(place))) return Sight::unknown;
        pixel = number_of(place);
        const GBufferTexel& texel = image_.texels[pixel];
        if (!(texel.depth > 0)) return Sight::empty;
        if (depth > texel.depth + bias_) return Sight::unknown;
        return depth >= texel.depth - bias_ ? Sight::surface : Sight::empty;
    }

    /// Whether a surface may be visible in a voxel whose middle is nearer to `place` than `radius`, m.
    /// `tiles`: of the picture.
    bool may_show_surface(const glm::vec3& place, float radius, const DepthTiles& tiles) const {
        glm::vec2 middle;
        const float depth = project(place, middle);
        if (depth + radius <= image_.view.origin.w) return false;
        // x / z is farther from x0 / z0 by (r + r |x0| / z0) / (z0 - r) at most.
        float reach = radius, turned = 0;
        if (!is_parallel(image_.view)) {
            const float nearest = depth - radius;
            if (!(nearest > 1e-6f * depth)) return true;  // about the viewer
            reach = radius / nearest;
            turned = reach;
        }
        const glm::vec2 off = reach * glm::vec2(glm::length(right_), glm::length(down_)) +
                              turned * glm::abs(middle - centre_) + 1.0f;
        if (!(glm::length(off) + glm::length(middle) < 1e9f)) return true;  // also what is no number
        const DepthTiles::Range range =
            tiles.about(middle.x - off.x, middle.y - off.y, middle.x + off.x, middle.y + off.y);
        const float margin = bias_ + radius + 1e-4f * std::abs(depth);
        return depth + margin >= range.least && depth - margin <= range.most;
    }

    /// Whether nothing speaks against a voxel being empty whose middle is seen to be: no plane of a visible
    /// surface crosses it, neither at its middle nor toward its corners, and nothing hides a part of it. A
    /// surface in a voxel may be visible beside the middle alone: at silhouettes, or because it is slanted.
    bool surely_empty(const glm::vec3& middle) const {
        glm::vec2 place;
        const float depth = project(middle, place);
        const float reach = half_ / pixel_height(image_.view, depth);
        constexpr glm::vec2 kTaps[] = {{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
        for (const glm::vec2& tap : kTaps) {
            const glm::vec2 at = glm::floor(place + reach * tap);
            if (!shows(at)) continue;
            const GBufferTexel& texel = image_.texels[number_of(at)];
            if (!(texel.depth > 0)) continue;
            if (depth >= texel.depth - bias_ || crosses(middle, at, texel)) return false;
        }
        return true;
    }

 private:
    /// view_place() of the view, with what is the same for all voxels computed once.
    float project(const glm::vec3& position, glm::vec2& place) const {
        const glm::vec3 offset = position - xyz_of(image_.view.origin);
        const float depth = glm::dot(offset, xyz_of(image_.view.forward));
        const float scale = is_parallel(image_.view) ? 1.0f : 1.0f / depth;
        place = centre_ + scale * glm::vec2(glm::dot(offset, right_), glm::dot(offset, down_));
        return depth;
    }
    bool shows(const glm::vec2& place) const {
        return place.x >= 0 && place.y >= 0 && place.x < size_.x && place.y < size_.y;
    }
    size_t number_of(const glm::vec2& place) const {
        return static_cast<size_t>(static_cast<uint32_t>(place.y)) * image_.view.width +
               static_cast<uint32_t>(place.x);
    }
    /// Whether the plane of a pixel's surface crosses the voxel.
    bool crosses(const glm::vec3& middle, const glm::vec2& pixel, const GBufferTexel& texel) const {
        const glm::vec3 normal = texel_normal(texel), off = glm::abs(normal);
        return std::abs(glm::dot(normal, middle - texel_position(image_.view, pixel, texel))) <=
               half_ * (off.x + off.y + off.z);
    }

    const SeenImage& image_;
    float half_, bias_ = 0;
    glm::vec3 right_{0.0f}, down_{0.0f};  ///< pixels a metre, at a depth of 1 m
    glm::vec2 centre_{0.0f}, size_{0.0f};
};

}  // namespace lucarne::gi::volume
