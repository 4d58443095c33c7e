#pragma once

#include <cstdint>

struct ImDrawData;

namespace lucarne::viewer {

/// A number for all that ImGui is about to draw: the same of two frames that look the same, another (but for
/// one in 2^64) of others. The contents of textures are not looked at.
uint64_t fingerprint(const ImDrawData& data);

}  // namespace lucarne::viewer
