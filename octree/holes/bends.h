#pragma once

#include <cstdint>
#include <vector>

#include "octree/holes/plane_grid.h"
#include "octree/holes/planes.h"
#include "octree/holes/voxels.h"

namespace lucarne::octree {

/// Which planes are parts of one bent surface, so that there is no crease between them.
class JoinedPlanes {
 public:
    explicit JoinedPlanes(size_t planes) : planes_(planes), joined_(planes * planes, false) {}
    void join(size_t a, size_t b) { joined_[a * planes_ + b] = joined_[b * planes_ + a] = true; }
    bool operator()(size_t a, size_t b) const { return joined_[a * planes_ + b]; }

 private:
    size_t planes_;
    std::vector<bool> joined_;
};

/// Finds where the surface of planes bends away from them smoothly (HolePlane::bend), as on a column, whose
/// planes are strips of 30 degrees, and widens the planes by that. A hole of such a plane ends there, and
/// gets its heights from there.
JoinedPlanes find_bends(const Voxels& voxels, std::vector<HolePlane>& planes);

/// Marks hidden cells beside bends as open that do not lie between two places of the surface or of creases: a
/// bent surface does not go straight on. Takes at most `work` steps, and returns how many it took.
uint64_t mark_beyond_bends(PlaneGrid& grid, const Voxels& voxels, uint64_t work);

}  // namespace lucarne::octree
