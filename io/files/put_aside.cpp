#include "io/files/put_aside.h"

#include <system_error>

#include <fmt/format.h>

namespace lucarne {

std::string put_aside(const std::filesystem::path& file, const Error& reason) {
    const std::filesystem::path aside = file.string() + ".broken";
    std::error_code error;
    std::filesystem::rename(file, aside, error);
    return fmt::format("{}; it is left out, the file is {}", reason.line(),
                       error ? "still there: " + error.message() : "now " + aside.string());
}

}  // namespace lucarne
