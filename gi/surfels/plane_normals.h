#pragma once

#include <span>

#include "gi/shared/flat_surfel.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi {

/// Gives surfels without a normal that of the surface about them; which of its sides is the front is chance.
/// Does nothing if nearly all have one: the others lie on no surface then. The cloud is divided like an
/// octree until what a cube holds lies in a plane, or is few: then the least-squares plane is that of all
/// surfels in it. Returns whether it gave any. The same surfels give the same normals, whatever the number of
/// threads.
bool add_plane_normals(std::span<FlatSurfel> surfels);
/// The same for surfels on the host. Those without a normal have a zero one.
bool add_normals_of_planes(std::span<Surfel> surfels);

}  // namespace lucarne::gi
