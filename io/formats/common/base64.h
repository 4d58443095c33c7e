#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucarne::io {

/// RFC 4648, section 4, with padding. A cache holds bytes in JSON in this form.
std::string to_base64(std::span<const std::byte> data);
std::optional<std::vector<std::byte>> from_base64(std::string_view text);  ///< empty if it is not base64

}  // namespace lucarne::io
