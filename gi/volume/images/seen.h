#pragma once

#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

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
        // The farthest corner of a voxel along the view axis (the thesis' bias b, equation 17, whose
        // listing 7.1 takes six times as much).
        const glm::vec3 along = glm::abs(xyz_of(image.view.forward));
        bias_ = half_ * (along.x + along.y + along.z);
    }

    /// Tells the sight of a voxel about `middle`. Sets `pixel` unless it is unknown.
    Sight at(const glm::vec3& middle, size_t& pixel) const {
        const CameraView& view = image_.view;
        float depth = 0;
        const glm::vec2 place = view_place(view, middle, depth);
        // A voxel beside or behind the viewer is in no picture; the comparisons are false for NaN, too.
        if (!(depth > view.origin.w) ||
            !(place.x >= 0 && place.y >= 0 && place.x < static_cast<float>(view.width) &&
              place.y < static_cast<float>(view.height)))
            return Sight::unknown;
        pixel = static_cast<size_t>(place.y) * view.width + static_cast<size_t>(place.x);
        const GBufferTexel& texel = image_.texels[pixel];
        if (!(texel.depth > 0)) return Sight::empty;
        if (depth > texel.depth + bias_) return Sight::unknown;
        return depth >= texel.depth - bias_ ? Sight::surface : Sight::empty;
    }

    /// Whether nothing speaks against a voxel being empty whose middle is seen to be: no plane of a visible
    /// surface crosses it, neither at its middle nor toward its corners, and nothing hides a part of it. A
    /// surface in a voxel may be visible beside the middle alone: at silhouettes, or because it is slanted.
    bool surely_empty(const glm::vec3& middle) const {
        const CameraView& view = image_.view;
        float depth = 0;
        const glm::vec2 place = view_place(view, middle, depth);
        const float reach = half_ / pixel_height(view, depth);
        constexpr glm::vec2 kTaps[] = {{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
        for (const glm::vec2& tap : kTaps) {
            const glm::vec2 at = glm::floor(place + reach * tap);
            if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(view.width) &&
                  at.y < static_cast<float>(view.height)))
                continue;
            const GBufferTexel& texel =
                image_.texels[static_cast<size_t>(at.y) * view.width + static_cast<size_t>(at.x)];
            if (!(texel.depth > 0)) continue;
            if (depth >= texel.depth - bias_ || crosses(middle, at, texel)) return false;
        }
        return true;
    }

 private:
    /// Whether the plane of a pixel's surface crosses the voxel.
    bool crosses(const glm::vec3& middle, const glm::vec2& pixel, const GBufferTexel& texel) const {
        const glm::vec3 normal = texel_normal(texel), off = glm::abs(normal);
        return std::abs(glm::dot(normal, middle - texel_position(image_.view, pixel, texel))) <=
               half_ * (off.x + off.y + off.z);
    }

    const SeenImage& image_;
    float half_, bias_ = 0;
};

}  // namespace lucarne::gi::volume
