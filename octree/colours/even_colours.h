#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "octree/tree/key.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/station_colour.h"

namespace lucarne::octree {

/// What is added to a point's colour when it is drawn, in kColourChangeSteps-ths of white (sRGB): to green,
/// and how much more to red and to blue. These two are small, and often 0.
using ColourChange = std::array<int8_t, 3>;
inline constexpr int kColourChangeSteps = 32;

/// Returns a colour (sRGB, 0 to 1) with its change, limited to 0 to 1.
inline glm::dvec3 changed_colour(const glm::dvec3& srgb, const ColourChange& change) {
    const glm::dvec3 steps(change[0] + change[1], change[0], change[0] + change[2]);
    return glm::clamp(srgb + steps / double{kColourChangeSteps}, 0.0, 1.0);
}

/// Evens out colours that differ from point to point at random: where a scanner, or a program that joined
/// its scans, took neighbouring points from photographs of different exposure or with different reflections.
/// Texture is left alone: its colours differ less the nearer two points are.
class ColourEvening {
 public:
    /// `schema` and `whites` outlive this object. `whites`: the value of a component at full intensity, of
    /// each input. `unit_area`: the unit of areas, in faces of the cube in which places are.
    ColourEvening(const io::Schema& schema, std::span<const double> whites, float unit_area = 1);

    /// Writes the `color_change` of a chunk's records, which are sorted along the Morton curve. `areas`:
    /// their shares of the surface, 0 if unknown. Memory: 300 kB. Does nothing where the schema has
    /// no `color_change`.
    void even(std::span<std::byte> records, std::span<const Place> places, std::span<const float> areas);

 private:
    void read(std::span<const std::byte> records, std::span<const Place> places, std::span<const float> areas,
              size_t first, size_t count);
    void find_rough_groups();
    bool weigh(size_t point);
    void compare(size_t point);
    ColourChange change_of(size_t point);

    const io::Schema& schema_;
    const std::span<const double> whites_;
    const float unit_area_;
    const StationKeys keys_;
    const PointNormals normals_;
    const io::Attribute *color_ = nullptr, *change_ = nullptr;
    /// Of the points of a block: positions in edges of the root cube, unit normals, sRGB, luma, squared
    /// radius of the neighbourhood (0: takes no part), station.
    std::vector<float> x_, y_, z_, normal_x_, normal_y_, normal_z_, luma_, radius2_;
    std::vector<uint32_t> station_;
    std::vector<glm::vec3> color_of_, mean_;
    std::vector<float> near_, all_;  ///< variance of luma among the nearest points, among the neighbours
    std::vector<bool> rough_;        ///< of groups of points: their colours may have to be evened
    struct Neighbour {
        uint32_t index = 0;
        float weight = 0;
    };
    std::vector<Neighbour> neighbour_;  ///< of the point that is asked; the first around_ count
    size_t around_ = 0;
};

}  // namespace lucarne::octree
