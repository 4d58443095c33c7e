#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

#include "io/files/byte_source.h"

namespace lucarne::fuzz {

/// What a fuzzer does with one input; each target defines it, driver.cpp calls it. False: the input is of no
/// use to the corpus (too short for the format).
bool run(const uint8_t* data, size_t size);

/// A file in memory with these bytes, the same one every time; nothing where the system has no memory for it.
std::optional<std::filesystem::path> memory_file(std::string_view bytes);
inline std::optional<std::filesystem::path> memory_file(const uint8_t* data, size_t size) {
    return memory_file({reinterpret_cast<const char*>(data), size});
}

/// These bytes, which outlive it; nothing lies beside them.
inline std::shared_ptr<const ByteSource> memory_source(std::string_view bytes) {
    return std::make_shared<const MemorySource>("/dev/null/fuzz", std::as_bytes(std::span(bytes)));
}

}  // namespace lucarne::fuzz
