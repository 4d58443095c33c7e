#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lucarne {

/// "2 points that are not there", of 1 "1 point that is not there". `many` is one of our own phrases, in the
/// plural: its first word that ends in s is the noun.
std::string counted(uint64_t count, std::string_view many);

}  // namespace lucarne
