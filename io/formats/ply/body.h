#pragma once

#include "io/formats/ply/header.h"

namespace lucarne::io::ply {

/// Compares a binary body without lists with what its header promises. Warns of bytes behind it. Where the
/// vertices surely differ from their description, changes that: doubles instead of floats, or properties
/// without a name as padding. With `salvage` the number of vertices may grow.
Result<void> fit_body(const ByteSource& file, Header& header, bool salvage);

}  // namespace lucarne::io::ply
