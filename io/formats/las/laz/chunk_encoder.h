#pragma once

#include <memory>

#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

/// Encodes records as one chunk of a file.
std::vector<std::byte> encode_chunk(const Compression& compression, std::span<const std::byte> records);

}  // namespace lucarne::io::laz
