#pragma once

#include "io/formats/pcd/header.h"
#include "io/formats/ply/layout.h"
#include "io/formats/text/rows.h"

// Converts the fields of a PCD file to a record of the schema.
namespace lucarne::io::pcd {

struct Layout {
    /// The binary record, laid out like a PLY vertex. The bytes of a packed colour are its properties blue,
    /// green and red.
    ply::Layout binary;
    text::RowLayout rows;  ///< for the ASCII encoding
};

/// Maps x, y, z to the position (f32 if all three are), and rgb and rgba (packed in 4 bytes) to `color` and
/// `alpha`. All other fields are treated as in PLY. Fields named "_" are padding. A field of several values
/// becomes that many attributes.
Layout make_layout(const Header& header);

}  // namespace lucarne::io::pcd
