#pragma once

#include "io/files/file.h"

namespace lucarne::io {

/// Whether OpenEXR may see this file: the library asks for memory by what a header says, and this looks
/// before it at what the file can hold. Errors: attributes, tables of chunks and previews larger than the
/// file; chunks and rows of tiles of more than 64 MiB; deep pictures, lists of identifiers, over 1000 parts,
/// a header over 16 MiB. Source: "OpenEXR File Layout", openexr.com.
Result<void> check_exr_header(const ByteSource& file);

}  // namespace lucarne::io
