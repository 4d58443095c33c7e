#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lucarne {

/// Returns the count and its noun phrase: "2 points that are not there", or for 1 "1 point that is not
/// there". `many` is one of the program's own phrases in the plural. Its first word that ends in s is the
/// noun.
std::string counted(uint64_t count, std::string_view many);

}  // namespace lucarne
