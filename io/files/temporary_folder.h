#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "io/core/error.h"

namespace lucarne {

/// A folder for this user alone in the system's place for temporary files. The destructor removes it with
/// everything in it; so does a signal that ends the program (io/core/interrupt.h).
class TemporaryFolder {
 public:
    static Result<TemporaryFolder> create();
    TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::move(other.path_)) { other.path_.clear(); }
    TemporaryFolder& operator=(TemporaryFolder&& other) noexcept {
        std::swap(path_, other.path_);
        return *this;
    }
    ~TemporaryFolder();
    const std::filesystem::path& path() const { return path_; }

 private:
    explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
    std::filesystem::path path_;
};

}  // namespace lucarne
