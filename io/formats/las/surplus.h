#pragma once

#include "io/formats/las/header.h"

// What follows the points of an uncompressed LAS file and belongs to nothing that the header names. Writers
// that were interrupted leave points there that the header does not count yet.
namespace lucarne::io::las {

/// Returns whether an extended record stands at this place: it is as long as the file can hold.
Result<bool> is_extended_record(const ByteSource& file, uint64_t offset);

/// Deals with the bytes between the last point that the header counts and `end`. Warns of them. With
/// `salvage` counts whole records there as points, up to the first that is empty or lies far outside the
/// stated box. Without a stated box records count only if the header promises no point at all.
Result<void> take_surplus(const ByteSource& file, Header& header, uint64_t end, bool salvage);

}  // namespace lucarne::io::las
