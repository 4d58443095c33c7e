#pragma once

#include "io/formats/copc/copc.h"

namespace lucarne::io::copc {

/// Reads all nodes of a file, those of the root page first. Errors: see File::open.
Result<std::vector<Node>> read_hierarchy(const ByteSource& file, const las::Header& header, const Info& info);

}  // namespace lucarne::io::copc
