#pragma once

#include <span>

struct ImFontAtlas;

namespace lucarne::viewer {

/// The font file of the interface (Inter, OpenType), which the build embeds.
std::span<const unsigned char> interface_font();

/// Adds the interface's font to an empty atlas, for texts of this height, pixels. It has the letters of the
/// languages that are written in Latin, Greek or Cyrillic letters, because names of files are shown.
void add_interface_font(ImFontAtlas& atlas, float pixels);

}  // namespace lucarne::viewer
