#pragma once

#include <cstdint>

struct ImDrawData;

namespace lucarne::viewer {

/// Returns a hash of all that ImGui is about to draw. Equal frames have equal hashes; different frames
/// collide with probability 2^-64. The contents of textures are not hashed.
uint64_t fingerprint(const ImDrawData& data);

}  // namespace lucarne::viewer
