#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "io/files/byte_source.h"

namespace lucarne::fuzz {

/// Runs a fuzzer on one input. Each target defines this function; driver.cpp calls it. Returns false if the
/// input is of no use to the corpus (too short for the format).
bool run(const uint8_t* data, size_t size);

/// Returns a file in memory with these bytes, always the same file. Returns nothing if the system has no
/// memory for it.
std::optional<std::filesystem::path> memory_file(std::string_view bytes);
inline std::optional<std::filesystem::path> memory_file(const uint8_t* data, size_t size) {
    return memory_file({reinterpret_cast<const char*>(data), size});
}

/// Returns a source of these bytes, which must outlive it. There are no files beside it.
inline std::shared_ptr<const ByteSource> memory_source(std::string_view bytes) {
    return std::make_shared<const MemorySource>("/dev/null/fuzz", std::as_bytes(std::span(bytes)));
}

}  // namespace lucarne::fuzz
