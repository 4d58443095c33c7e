#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace lucarne::viewer {

/// What the side bar is made of, from its top to its bottom.
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
    controller
};
inline constexpr size_t kSections = 10;

/// As the settings' file calls them.
inline constexpr std::array<std::string_view, kSections> kSectionNames = {
    "scans",     "rendering",  "look",    "light",      "measure",
    "bookmarks", "flythrough", "picture", "statistics", "controller"};

/// The one place where panels stand: sections that open and close, on the left of the window.
struct SideBar {
    static constexpr double kLeast = 20, kMost = 80;  ///< width, of the text's height

    bool shown = true;
    double width = 25;  ///< likewise
    std::array<bool, kSections> open = {true, true, true, true};
    std::optional<BarSection> sought;  ///< is to be scrolled to

    bool is_open(BarSection section) const { return open[static_cast<size_t>(section)]; }
    bool shows(BarSection section) const { return shown && is_open(section); }
    /// A bar that the user has put away stays away.
    void unfold(BarSection section) {
        open[static_cast<size_t>(section)] = true;
        sought = section;
    }
    /// Closes what is seen; else it is opened, and the whole bar with it.
    void toggle(BarSection section) {
        if (shows(section)) {
            open[static_cast<size_t>(section)] = false;
        } else {
            shown = true;
            unfold(section);
        }
    }
    /// Pixels that it covers in a window so many pixels wide, of which the picture keeps two fifths.
    double pixels(double text_height, double window_width) const;
};

}  // namespace lucarne::viewer
