#include "viewer/commands/options/shown_site.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "octree/tree/footprint.h"
#include "viewer/camera/fitting.h"

namespace lucarne::viewer {
namespace {

/// Up to so many places a disc is a visible share of the extent.
constexpr size_t kFewPlaces = 16;

/// Returns the largest radius of discs of the coarsest nodes, world units.
double disc_radius(const octree::NodeSource& source) {
    double spacing = 0;
    for (const uint32_t root : source.roots())
        spacing = std::max(spacing, static_cast<double>(source.nodes()[root].spacing()));
    const auto area = static_cast<float>(spacing * spacing);
    const double radius = octree::surfel_radius(0, area);
    return std::isfinite(radius) ? radius : 0;
}

}  // namespace

Site shown_site(const octree::NodeSource& source) {
    Site site = survey_site(source);
    if (site.outline.size() > kFewPlaces) return site;
    const double reach = disc_radius(source), least = kLeastBox / site.metres_per_unit;
    std::vector<glm::dvec3> outline;
    for (const glm::dvec3& place : site.outline) {
        const auto [low, high] = widened({place, place}, reach, least);
        for (int corner = 0; corner < 8; ++corner)
            outline.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                 corner & 4 ? high.z : low.z);
    }
    site.outline = std::move(outline);
    site.box = widened(site.box, reach, least);
    return site;
}

}  // namespace lucarne::viewer
