#pragma once

#include "io/files/file.h"

namespace lucarne::io {

/// Checks whether it is safe to let OpenEXR read a file. The library allocates what a header says; this
/// compares the header with the size of the file first. Errors: attributes, chunk tables and previews larger
/// than the file; chunks and rows of tiles of more than 64 MiB; deep pictures, lists of identifiers, over
/// 1000 parts, a header over 16 MiB. Source: "OpenEXR File Layout", openexr.com.
Result<void> check_exr_header(const ByteSource& file);

}  // namespace lucarne::io
