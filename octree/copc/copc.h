#pragma once

#include <memory>

#include "io/files/byte_source.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Opens a COPC file as the octree that it is (io/formats/copc/copc.h): nothing is converted. Its voxel keys
/// are our node keys; a node's points are put into prefix order when it is loaded, with unsigned normals
/// estimated among them where the file has none. There are no areas: the floors say what a point stands for,
/// by a sample of the top of the tree and the counts of nodes. Errors: those of io::copc::File::open; nodes
/// that are there twice or have no parent.
Result<std::unique_ptr<NodeSource>> open_copc(std::shared_ptr<const ByteSource> input);

}  // namespace lucarne::octree
