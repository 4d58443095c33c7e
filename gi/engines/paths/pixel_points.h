#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/host_frame.h"

namespace lucarne::gi::paths {

/// The gathering points of the pixels of a picture, or of kMostPixels of them at a time. While bake, camera
/// and surfaces stay as they are, they are found once: a lamp that is dragged costs no search.
class PixelPoints {
 public:
    static constexpr size_t kMostPixels = size_t{1} << 21;  ///< some 100 MB

    /// Finds the points of the pixels from `first` on. `surfaces` are those of `texels`, of all pixels.
    /// `offset`: of the bake's coordinates in those of the frame (Frame::bake_offset).
    void find(const PathsBake& bake, const CameraView& camera, std::span<const GBufferTexel> texels,
              std::span<const SurfacePoint> surfaces, const glm::vec3& offset, size_t first);
    /// The points of pixel `first` + i; empty where it shows no surface or none is near.
    std::span<const PointShare> of(size_t i) const { return sharing_.of(i); }
    /// How many pixels there are.
    size_t count() const { return sharing_.first.size() - 1; }
    /// How many of these no point reaches.
    size_t alone() const { return alone_; }

 private:
    const PathsBake* bake_ = nullptr;
    uint64_t key_ = 0;
    Sharing sharing_;
    size_t alone_ = 0;
};

}  // namespace lucarne::gi::paths
