#include "io/files/user_folder.h"

#include <cstdlib>

#include <fmt/format.h>

#include "io/core/random.h"

namespace lucarne {

std::filesystem::path absolute_folder(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value == '/' ? std::filesystem::path(value) : std::filesystem::path();
}

std::filesystem::path user_folder(const char* variable, const char* below_home) {
    if (const auto given = absolute_folder(variable); !given.empty()) return given / "lucarne";
    if (const auto home = absolute_folder("HOME"); !home.empty()) return home / below_home / "lucarne";
    return {};
}

std::string kept_name(std::string_view path) {
    uint64_t hash = 0;
    for (const char c : path) hash = mix64(hash, static_cast<unsigned char>(c));
    return fmt::format("{:016x}", hash);
}

}  // namespace lucarne
