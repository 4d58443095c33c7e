#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/holes/holes.h"

namespace lucarne::octree {

enum class Sight : uint8_t {
    hidden,   ///< behind nearer points of all stations, or out of their sight
    surface,  ///< a station saw a surface about there
    through,  ///< a station looked through
};

/// How far each station saw in each direction: cube maps of the range of its nearest points.
class StationViews {
 public:
    /// `memory`: bytes for all maps; with more stations their cells are larger.
    StationViews(const HoleSample& sample, uint64_t memory);

    bool empty() const { return views_.empty(); }
    /// What the stations saw at a place of a surface with this normal. A station looked through if it
    /// received nothing from this direction, or from at least `behind` (m) farther away. Directions below
    /// everything that it received do not count: the tripod stands there.
    Sight at(const glm::vec3& place, const glm::vec3& normal, float behind) const;

 private:
    struct View {
        glm::vec3 position{0.0f};
        float below = -1;          ///< z of the direction below which nothing can have been received
        std::vector<float> range;  ///< m; infinity: nothing was received
    };
    void close_gaps(View& view) const;
    void splat(View& view, const HolePoint& point, float radius) const;
    static void find_lowest(View& view, std::vector<float>& heights);

    uint32_t side_ = 0;  ///< cells along a face
    std::vector<View> views_;
};

}  // namespace lucarne::octree
