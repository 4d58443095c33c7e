#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace lucarne::viewer {

/// The sections of the side bar, from top to bottom.
enum class BarSection : uint8_t {
    scans,
    rendering,
    look,
    light,
    measure,
    bookmarks,
    flythrough,
    picture,
    statistics,
    controller,
    preferences
};
inline constexpr size_t kSections = 11;

/// The sections' names in the settings file.
inline constexpr std::array<std::string_view, kSections> kSectionNames = {
    "scans",      "rendering", "look",       "light",      "measure",    "bookmarks",
    "flythrough", "picture",   "statistics", "controller", "preferences"};

/// The side bar on the left of the window. It contains all panels as sections that open and close.
struct SideBar {
    static constexpr double kLeast = 17, kMost = 70;  ///< limits of the width, in heights of the text

    bool shown = true;
    double width = 21;                          ///< in heights of the text
    std::array<bool, kSections> open = {true};  ///< at first the scans; moods and tools are over the picture
    std::optional<BarSection> sought;           ///< the section to scroll to

    bool is_open(BarSection section) const { return open[static_cast<size_t>(section)]; }
    bool shows(BarSection section) const { return shown && is_open(section); }
    /// Opens a section and scrolls to it. A hidden bar stays hidden.
    void unfold(BarSection section) {
        open[static_cast<size_t>(section)] = true;
        sought = section;
    }
    /// Closes a visible section. Otherwise opens it and shows the bar.
    void toggle(BarSection section) {
        if (shows(section)) {
            open[static_cast<size_t>(section)] = false;
        } else {
            shown = true;
            unfold(section);
        }
    }
    /// Returns the bar's width in pixels. The picture keeps at least two fifths of the window's width.
    double pixels(double text_height, double window_width) const;
};

}  // namespace lucarne::viewer
