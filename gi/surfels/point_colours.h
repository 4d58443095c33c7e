#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "octree/tree/source.h"

namespace lucarne::gi {

/// The colours of a node's points, as sRGB from 0 to 1. If they are balanced, random differences are evened
/// out (octree/colours/even_colours.h), the gains of the stations are applied, and points that were never
/// photographed get the colour of the points around them (octree/tree/station_colour.h).
class PointColours {
 public:
    /// The arguments outlive this object.
    PointColours(const octree::SourceHeader& header, const octree::Cube& cube, const octree::NodeData& data,
                 bool balanced);

    /// Returns the colour of a point of the node, none if it has none.
    std::optional<glm::dvec3> of(const std::byte* record, const glm::dvec3& position);

 private:
    /// The balanced sRGB values of one station's sRGB values, i / 255 each.
    using Curves = std::array<std::array<float, 257>, 3>;
    struct Station {
        octree::StationKey key;
        double white = 255;
        const octree::StationColour* colour = nullptr;
        const Curves* curves = nullptr;  ///< null: gains of 1
    };
    const Station& station_of(const std::byte* record);
    const Curves* curves_of(const octree::StationColour& colour);
    glm::dvec3 raw(const std::byte* record) const;
    glm::dvec3 balanced(const std::byte* record, const glm::dvec3& raw, const Station& station) const;
    bool never_photographed(const glm::dvec3& raw, const glm::dvec3& position, const Station& station) const;
    void mark_black_cells();
    glm::dvec3 colour_around(const glm::dvec3& position, const glm::dvec3& otherwise);
    void sum_up_cells();

    const octree::SourceHeader& header_;
    const octree::Cube& cube_;  // of the node
    const octree::NodeData& data_;
    const octree::StationKeys keys_;
    bool balanced_;
    const io::Attribute *color_ = nullptr, *change_ = nullptr;  ///< null: points have none
    std::optional<Station> last_;
    std::map<const octree::StationColour*, std::unique_ptr<const Curves>> curves_;
    std::vector<bool> black_;  ///< which of 16^3 cells have points that are 0,0,0 and should not be
    /// Sums of linear colours and their numbers over 32^3, 16^3, ... 1 cells of the cube; empty until they
    /// are needed.
    std::vector<std::vector<glm::vec4>> cells_;
};

}  // namespace lucarne::gi
