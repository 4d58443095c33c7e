#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/host_frame.h"

namespace lucarne::gi::paths {

/// The gathering points of the pixels of a picture. While bake, camera and surfaces stay as they are, they
/// are found once: a lamp that is dragged costs no search.
class PixelPoints {
 public:
    /// Most shares and pixels that are kept, of 8 bytes at most: some 4 million pixels of 6 points each, 256
    /// MB. The points of pixels after these are searched in every call.
    static constexpr size_t kMostKept = size_t{1} << 25;
    explicit PixelPoints(size_t most_kept = kMostKept) : most_kept_(most_kept) {}

    /// Begins a picture. `offset`: of the bake's coordinates in those of the frame (Frame::bake_offset);
    /// `lists`: how its pixels are listed. What was found for the same picture is kept.
    void begin(const PathsBake& bake, const CameraView& camera, std::span<const GBufferTexel> texels,
               const glm::vec3& offset, uint64_t lists);
    /// Calls visit(i, shares) for all surfaces[i] that are there, those of some pixels, from many threads at
    /// a time. Empty shares: no point is near. `list` names the pixels: they must be the same in every call
    /// for one picture.
    using Visit = std::function<void(size_t, std::span<const PointShare>)>;
    enum class List : uint8_t { grid, rest };
    void visit(List list, std::span<const SurfacePoint> surfaces, const Visit& visit);
    /// For how many pixels of the picture points were searched, in all calls.
    size_t searched() const { return searched_; }
    /// How many of the pixels that were visited no point reaches.
    size_t alone() const { return alone_[0] + alone_[1]; }

 private:
    /// The points of consecutive pixels.
    struct Piece {
        Sharing points;
        size_t alone = 0;
        size_t size() const { return points.first.size() + points.shares.size(); }
    };
    Piece find(std::span<const SurfacePoint> surfaces) const;

    size_t most_kept_, kept_ = 0;
    const PathsBake* bake_ = nullptr;
    uint64_t key_ = 0;
    glm::vec3 offset_{0.0f};
    std::array<std::vector<Piece>, 2> found_;  ///< by list: from the first pixels on
    std::array<size_t, 2> alone_{};
    size_t searched_ = 0;
};

}  // namespace lucarne::gi::paths
