#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace lucarne {

/// `folder`/`stem`-0001, or the next number whose name is free with every one of the extensions (".png");
/// without an extension.
std::filesystem::path free_name(const std::filesystem::path& folder, std::string_view stem,
                                std::initializer_list<std::string_view> extensions);

}  // namespace lucarne
