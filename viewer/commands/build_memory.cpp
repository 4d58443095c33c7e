#include "viewer/commands/build_memory.h"

#include <fmt/format.h>

#include "io/core/options.h"

namespace lucarne::viewer {
namespace {

/// What the process holds besides the plan of a build: 14 to 16 MiB before it reads a point, mostly its
/// libraries, and up to 8 MiB of the allocator's reserves and the stages after the build (4M points with
/// normals, measured).
constexpr uint64_t kProgram = uint64_t{24} << 20;
constexpr uint64_t kLeastCap = uint64_t{48} << 20;

}  // namespace

Result<uint64_t> build_memory(const std::string& cap) {
    LUCARNE_ASSIGN(const uint64_t bytes, parse_bytes("--memory", cap));
    if (bytes < kLeastCap)
        return bad_arguments("--memory",
                             fmt::format("{} is too little, the program alone takes {}", bytes_text(bytes),
                                         bytes_text(kProgram)),
                             fmt::format("give at least {}", bytes_text(kLeastCap)));
    return bytes - kProgram;
}

}  // namespace lucarne::viewer
