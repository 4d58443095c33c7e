#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace lucarne {

/// Returns `folder`/`stem`-0001, or the same with the next number for which no file with any of the
/// extensions (".png") exists. The result has no extension. If all 9999 names are taken, returns
/// `folder`/`stem`, which may exist: the caller must not overwrite it.
std::filesystem::path free_name(const std::filesystem::path& folder, std::string_view stem,
                                std::initializer_list<std::string_view> extensions);

}  // namespace lucarne
