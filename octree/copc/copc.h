#pragma once

#include <memory>

#include "io/files/byte_source.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Opens a COPC file as an octree (io/formats/copc/copc.h); nothing is converted. Its voxel keys are used as
/// node keys. When a node is loaded, its points are put into prefix order, and unsigned normals are estimated
/// among them if the file has none. There are no areas: the floors say how much surface a point represents,
/// from a sample of the top of the tree and the counts of nodes. Errors: those of io::copc::File::open; nodes
/// that occur twice or have no parent.
Result<std::unique_ptr<NodeSource>> open_copc(std::shared_ptr<const ByteSource> input);

}  // namespace lucarne::octree
