#include "gi/volume/surfel_voxels.h"

#include <vector>

#include <glm/geometric.hpp>

#include "gi/surfels/flat_surfels.h"
#include "gi/tracing/surfel_tracer.h"
#include "gi/volume/voxel_sums.h"
#include "gi/volume/voxels.h"

namespace lucarne::gi::volume {
namespace {

std::vector<FlatSurfel> flat_discs(std::span<const Surfel> surfels) {
    std::vector<FlatSurfel> flat;
    flat.reserve(surfels.size());
    for (const Surfel& surfel : surfels) {
        flat.push_back(flat_disc(surfel));
        if (!tracing::has_disc(surfel)) flat.back().radius = 0;
    }
    return flat;
}

Result<VoxelSet> voxels_of_discs(std::span<const Surfel> surfels, std::span<const FlatSurfel> flat,
                                 const Grid& grid, const glm::dvec3& origin) {
    if (grid.cells() == 0)
        return rejected("voxels", "no point has a normal and a size",
                        "see that the scan has normals (--normals)");
    LUCARNE_ASSIGN(const Voxels voxels, Voxels::divide(flat, grid));
    const float face = grid.voxel * grid.voxel;
    std::vector<VoxelPart> parts;
    parts.reserve(voxels.all_parts());
    for (uint32_t voxel = 0; voxel < voxels.occupied().size(); ++voxel)
        for (const SurfelPart& part : voxels.parts(voxel)) {
            const float area = part.area / face;
            const Surfel& surfel = surfels[part.surfel];
            parts.push_back({voxels.occupied()[voxel], area, area * surfel.normal, area * surfel.albedo});
        }
    VoxelSums sums;
    sums.add(parts);
    return sums.means(grid, origin);
}

}  // namespace

Result<VoxelSet> voxels_of_surfels(std::span<const Surfel> surfels, uint32_t longest,
                                   const glm::dvec3& origin) {
    const auto flat = flat_discs(surfels);
    return voxels_of_discs(surfels, flat, grid_about(flat, longest), origin);
}

Result<VoxelSet> voxels_of_surfels(std::span<const Surfel> surfels, const Grid& grid,
                                   const glm::dvec3& origin) {
    return voxels_of_discs(surfels, flat_discs(surfels), grid, origin);
}

}  // namespace lucarne::gi::volume
