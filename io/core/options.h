#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/core/error.h"

namespace lucarne {

/// Converts "512M", "2G", "1.5GiB" or "4096" to bytes (binary units). `option` names the option in the error.
Result<uint64_t> parse_bytes(std::string_view option, std::string_view text);

/// Converts "250000", "5M", "1.5k" or "2G" to a count (powers of 1000), at most 2^53. `option` names the
/// option in the error.
Result<uint64_t> parse_count(std::string_view option, std::string_view text);

struct ImageSize {
    uint32_t width = 0, height = 0;
    bool operator==(const ImageSize&) const = default;
};
/// Converts "1280x720" to a size. Width and height must be between 1 and 16384.
Result<ImageSize> parse_size(std::string_view option, std::string_view text);

/// Returns what to do about an unknown name: "did you mean vpl? (all: direct, vpl)" if one of the names is
/// the nearest and differs in at most two letters and a third of them, else "choose one of: direct, vpl".
std::string advice(std::string_view unknown, std::span<const std::string_view> names);

/// Returns an amount as text: "1.5 GiB".
std::string bytes_text(uint64_t bytes);

}  // namespace lucarne
