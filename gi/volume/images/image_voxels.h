#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/volume/voxel_set.h"

namespace lucarne::gi::volume {

/// A picture from which voxels are updated: what a camera or a light sees.
struct SeenImage {
    CameraView view;
    std::span<const GBufferTexel> texels;  ///< of view.width * view.height pixels, row 0 on top
    /// The light that surfaces send out, by pixel, in any unit; empty: none is known. A light's image has its
    /// own light alone, which is added to that of other lights; a camera's has all of it.
    std::span<const glm::vec3> light = {};
    bool of_light = false;
};

/// A voxel that pictures have shown.
struct SeenVoxel {
    glm::ivec3 cell{0};     ///< counted from the zero of the coordinates, so also negative
    uint32_t normal = 0;    ///< octahedral, toward the viewers; kNoSide: they saw both sides
    uint32_t albedo = 0;    ///< as GBufferTexel's, without its flags
    glm::vec3 light{0.0f};  ///< of the last pictures that showed it
    static constexpr uint32_t kNoSide = 0x80008000u;  ///< no code of a direction
};

/// How pictures update voxels.
struct ImageUpdate {
    /// Samples across the longer side of a picture that are injected; 0: every pixel.
    uint32_t samples = 0;
    /// One pass over all voxels in the place of cleanup and injection (Gaitatzes 2012, chapter 7.4.3).
    bool fused = false;
    /// Clears no voxel that may hold a part of a surface which is visible beside its middle
    /// (VoxelSight::surely_empty()). The thesis compares depths at the middle alone.
    bool careful = true;
};

class VoxelSight;

/// Voxels of what pictures have shown over time (Gaitatzes 2012, chapter 7): each update clears those that
/// are seen to be empty, and fills those in which surfaces are seen. Others stay as they are. The window of
/// voxels may move; voxels that stay inside keep their content, because cells are addressed modulo the size
/// of the window. Memory: 4 bytes a cell and some 200 a filled voxel.
class ImageVoxels {
 public:
    /// A window of `size` cells with this side, m. `low`: its lowest cell.
    ImageVoxels(const glm::ivec3& size, float voxel, const glm::ivec3& low);

    /// Moves the window. Voxels outside it are forgotten.
    void move_to(const glm::ivec3& low);
    /// Updates the voxels from pictures taken at the same time. Gives the same result for any number of
    /// threads.
    void update(std::span<const SeenImage> images, const ImageUpdate& how = {});
    /// Forgets all voxels.
    void clear();

    const glm::ivec3& low() const { return low_; }
    const glm::ivec3& size() const { return grid_.size; }
    float voxel() const { return grid_.voxel; }
    /// The filled voxels, in no particular order.
    std::span<const SeenVoxel> voxels() const { return voxels_; }
    /// Returns the filled voxel at a cell; null if there is none.
    const SeenVoxel* at(const glm::ivec3& cell) const;
    /// Returns the filled voxels as a set in the window's grid, without areas.
    VoxelSet set() const;

 private:
    /// Sums over the samples in a voxel; `frame` and `image` tell for which they hold.
    struct Sums {
        uint64_t frame = 0;
        glm::vec3 normal{0.0f}, albedo{0.0f}, image_light{0.0f};
        float count = 0, image_count = 0;
        uint32_t image = 0;
        bool lit = false;
    };
    bool holds(const glm::ivec3& cell) const { return grid_.holds(cell - low_); }
    uint32_t slot(const glm::ivec3& cell) const;
    template <class Stays>
    void keep(const Stays& stays);
    void clean(std::span<const SeenImage> images, const ImageUpdate& how);
    void inject(std::span<const SeenImage> images, const ImageUpdate& how);
    void inject(const SeenImage& image, uint32_t number, const ImageUpdate& how);
    void finish_image(const SeenImage& image);
    std::vector<uint8_t> shown_bricks(std::span<const VoxelSight> sights,
                                      std::span<const SeenImage> images) const;
    void fuse(std::span<const SeenImage> images, const ImageUpdate& how);
    void fuse_cell(std::span<const VoxelSight> sights, std::span<const SeenImage> images,
                   const ImageUpdate& how, const glm::ivec3& cell, uint32_t number,
                   std::vector<SeenVoxel>& row) const;

    Grid grid_;  ///< its size and voxel only
    glm::ivec3 low_;
    std::vector<uint32_t> numbers_;  ///< by slot: of the voxel; kEmptySlot: none
    std::vector<SeenVoxel> voxels_;  ///< V_curr of the thesis
    std::vector<SeenVoxel> before_;  ///< V_prev: the two change places in each pass
    std::vector<Sums> sums_;         ///< by voxel, of the update under way
    std::vector<uint32_t> touched_;  ///< voxels with samples of the picture under way
    std::vector<uint32_t> filled_;   ///< voxels with samples of this update
    uint64_t frame_ = 0;
};

}  // namespace lucarne::gi::volume
