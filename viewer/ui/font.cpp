#include "viewer/ui/font.h"

#include <imgui.h>

namespace lucarne::viewer {
namespace {

/// First and last letters of ranges, ended by 0. The atlas keeps the pointer.
constexpr ImWchar kLetters[] = {0x20,   0x17f,   // Latin with the accents of Europe
                                0x386,  0x3ce,   // Greek
                                0x400,  0x45f,   // Cyrillic
                                0x2010, 0x2026,  // dashes, quotation marks, ellipsis
                                0};

}  // namespace

void add_interface_font(ImFontAtlas& atlas, float pixels) {
    const std::span<const unsigned char> font = interface_font();
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = true;
    config.GlyphRanges = kLetters;
    // ImGui takes the file as writable, but only reads it.
    atlas.AddFontFromMemoryTTF(const_cast<unsigned char*>(font.data()), static_cast<int>(font.size()), pixels,
                               &config);
}

}  // namespace lucarne::viewer
