#pragma once

#include "io/formats/pcd/header.h"
#include "io/formats/ply/layout.h"
#include "io/formats/text/rows.h"

// How the fields of PCD become a record of ours.
namespace lucarne::io::pcd {

struct Layout {
    /// Of the binary record, which is laid out as a PLY vertex would be; the bytes of a packed colour are its
    /// properties blue, green and red.
    ply::Layout binary;
    text::RowLayout rows;  ///< of the ASCII encoding
};

/// x, y, z become the position, f32 where all three are; rgb and rgba (packed in 4 bytes) `color` and
/// `alpha`; the rest goes as in PLY. Fields named "_" are padding. A field of several values becomes as many
/// attributes.
Layout make_layout(const Header& header);

}  // namespace lucarne::io::pcd
