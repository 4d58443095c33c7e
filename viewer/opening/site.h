#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::viewer {

/// What a scan shows, which decides from where and in which light it is seen first.
enum class SiteKind : uint8_t {
    object,   ///< seen from outside: a statue, a façade, a house with its surroundings
    terrain,  ///< one layer, much wider than high
    interior  ///< rooms, seen from within
};
std::string_view site_name(SiteKind kind);

/// A free place beside a wall, and a place at the wall's far end: light from one to the other grazes the
/// wall.
struct AlongWall {
    glm::dvec3 from{0.0}, to{0.0};
};

/// A place to stand in a room. World units, directions are unit vectors.
struct StandingPlace {
    glm::dvec3 eye{0.0};
    glm::dvec3 ahead{0.0, 1.0, 0.0};  ///< horizontal, along the room
    double free_ahead = 0;            ///< distance to what stands there
    double floor = 0, ceiling = 0;    ///< z, at the eye
    std::vector<glm::dvec3> lamps;    ///< free places below the ceiling along the room, where lamps light it
    AlongWall left_wall;
    /// The direction of a sun that shines into the room, as through its windows; none if there is no opening.
    std::optional<glm::dvec3> sunward;
};

/// What is known about a scan before it is shown.
struct Site {
    SiteKind kind = SiteKind::object;
    double enclosed_share = 0;        ///< of the places to stand, those in rooms
    std::array<glm::dvec3, 2> box{};  ///< robust bounds
    double metres_per_unit = 1;
    glm::dvec3 cast{1.0};   ///< colour of the light in which the scan was photographed, linear, luminance 1
    bool coloured = true;   ///< points have colours other than black
    double brightness = 1;  ///< how many times as bright dark colours are shown
    bool sure = true;       ///< false: seen in few points, more of which may show something else
    std::vector<glm::dvec3> outline;      ///< points that a view of all has to contain; at least one
    std::optional<StandingPlace> inside;  ///< if there is a room
    /// Where the scanner stood, if all was scanned from one place, which sees it. Not set if the site is seen
    /// first from inside.
    std::optional<glm::dvec3> station;
};

/// Where the scanner stood, as far as is known. World units.
struct ScannerPlaces {
    std::vector<glm::dvec3> places;
    std::optional<glm::dvec3> only;  ///< from which all is said to be scanned
};

/// Looks at a sample of the coarsest nodes (up to 64 of them are loaded, so it may block). Nodes that cannot
/// be read are left out. An empty cloud is an object around its box.
Site survey_site(const octree::NodeSource& source);

/// Points from which a site is sure.
inline constexpr size_t kEnoughPoints = 100'000;

/// The same for points that are known already, in a box (world units). `has_gaps`: as of SourceHeader.
Site survey_site(std::span<const glm::dvec3> points, const std::array<glm::dvec3, 2>& box,
                 double metres_per_unit, bool has_gaps = false, const ScannerPlaces& stations = {});

/// Returns whether two sites are of one kind, or between two kinds, and their boxes differ by less than a
/// twentieth, as those of a sample and of more points of the same scan do: views and light made for one suit
/// the other.
bool alike(const Site& a, const Site& b);

/// Returns whether the views from inside two sites (if both are seen from there) are about the same: the
/// directions differ by less than 45 degrees and the places by less than a quarter of the way ahead.
bool shown_alike(const Site& a, const Site& b);

}  // namespace lucarne::viewer
