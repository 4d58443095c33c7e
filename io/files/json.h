#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "io/core/error.h"

namespace lucarne {

/// Reads a JSON text written by a person (a scene, a camera path). Errors name the line and column.
Result<nlohmann::json> parse_json(std::string_view text, const std::string& name);
/// Load such a file, of at most 16 MiB, as text or as JSON.
Result<std::string> load_text(const std::filesystem::path& path);
Result<nlohmann::json> load_json(const std::filesystem::path& path);

/// Returns the text for a JSON file: indented, with a final line end. Bytes that are not UTF-8, as file names
/// may hold, become U+FFFD.
template <class Json>
std::string json_text(const Json& value) {
    return value.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

struct JsonRange {
    double least = -1e300, most = 1e300;
};

/// Reads one object of such a file key by key. Every error names the file and the place as a JSON pointer: a
/// missing or unknown key, a wrong type, a number out of range. Refers to the document, which must outlive
/// it.
class JsonObject {
 public:
    static Result<JsonObject> of(const nlohmann::json& value, std::string name, std::string pointer = "");

    bool has(std::string_view key) const;
    // Each function reads the value of `key` and marks the key as known. Without `otherwise` the key is
    // required.
    Result<double> number(std::string_view key, JsonRange range = {}, std::optional<double> otherwise = {});
    Result<int64_t> integer(std::string_view key, int64_t least, int64_t most,
                            std::optional<int64_t> otherwise = {});
    Result<std::string> text(std::string_view key, std::optional<std::string> otherwise = {});
    Result<bool> boolean(std::string_view key, std::optional<bool> otherwise = {});
    /// [x, y, z], every component within the range.
    Result<glm::dvec3> vector(std::string_view key, JsonRange range = {},
                              std::optional<glm::dvec3> otherwise = {});
    /// An array of at most `most_of_them` integers. Empty if the key is missing.
    Result<std::vector<int64_t>> integers(std::string_view key, int64_t least, int64_t most,
                                          size_t most_of_them);
    /// A text that must be one of `choices`. Returns its index.
    Result<size_t> choice(std::string_view key, const std::vector<std::string_view>& choices,
                          std::optional<size_t> otherwise = {});
    /// An array of at most `most` objects. Empty if the key is missing.
    Result<std::vector<JsonObject>> objects(std::string_view key, size_t most = 10000);
    /// An object. Empty if the key is missing.
    Result<std::optional<JsonObject>> object(std::string_view key);

    /// Call this last: a key that no function above has read is an error.
    Result<void> finish() const;
    /// Returns an error about this object, or about one of its keys.
    tl::unexpected<Error> wrong(std::string why, std::string_view key = {}) const;

 private:
    JsonObject(const nlohmann::json& value, std::string name, std::string pointer)
        : value_(&value), name_(std::move(name)), pointer_(std::move(pointer)) {}
    const nlohmann::json* take(std::string_view key);
    std::string pointer_to(std::string_view key) const;
    tl::unexpected<Error> wrong_or_missing(std::string_view key, std::string_view expected) const;

    const nlohmann::json* value_;
    std::string name_, pointer_;
    std::vector<std::string> taken_;
};

}  // namespace lucarne
