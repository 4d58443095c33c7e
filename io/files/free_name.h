#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace lucarne {

/// Returns `folder`/`stem`-0001, or the same with the next number for which no file with any of the
/// extensions (".png") exists. The result has no extension.
std::filesystem::path free_name(const std::filesystem::path& folder, std::string_view stem,
                                std::initializer_list<std::string_view> extensions);

}  // namespace lucarne
