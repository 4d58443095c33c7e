#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// A node of a cut and how long a prefix of it is used.
struct CutNode {
    uint32_t node = 0;
    uint32_t count = 0;
    /// What loading it adds to the picture by the point: pixels covered times the pixels by which the points'
    /// spacing falls there. Larger is sooner.
    float priority = 0;
};

/// The nodes chosen for a purpose: closed under parents, sorted by node index. All nodes but the cut's leaves
/// are used whole; a leaf's prefix is where the level of detail fades in.
struct Cut {
    std::vector<CutNode> nodes;
    uint64_t points = 0;
    uint64_t visited = 0;     ///< nodes looked at to choose these
    bool budget_hit = false;  ///< the wanted spacing was not reached everywhere
};

/// A pinhole view in world units (the file's), for choosing nodes.
struct View {
    glm::dvec3 position{0.0}, forward{0.0, 1.0, 0.0}, right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0};  ///< unit axes
    double tan_half_width = 1, tan_half_height = 1;
    uint32_t width = 1, height = 1;  ///< pixels or shadow-map texels
    double near_plane = 1e-3;
    std::function<bool(const Cube&)> wanted{};  ///< whether any point in a cube is to be seen; none: all are
};

/// What a camera sees, refined where the projected spacing of the points is largest until it is under
/// `pixel_spacing` pixels everywhere or `budget` points are taken. Nodes outside the view are left out. A
/// node fades in by its prefix between the distance where its parent's spacing is too wide and that where its
/// own is just fine enough: a move that changes a node's distance by a small share e changes its prefix by at
/// most 10 e of its count (with a budget that is not hit). More budget never makes any place coarser.
Cut view_cut(const NodeSource& source, const View& view, uint64_t budget, double pixel_spacing = 1.0);

/// The same for a light's view (a shadow map or light G-buffer): the receivers must not be finer than the
/// casters, so it follows the spacing seen from the light.
Cut light_view_cut(const NodeSource& source, const View& light, uint64_t budget, double texel_spacing = 1.0);

/// What may bounce or block light: everything, seen or not, refined toward `centre` (the camera's focus) in
/// proportion to distance, as fine as `budget` allows. It is refined toward `lamps` as well: what stands
/// close before a lamp throws its discs' rims far, and its wall takes most of its light. `extent`: of what is
/// looked at, world units, where that is less than all there is (octree/tree/bulk.h); 0: all.
Cut light_cut(const NodeSource& source, const glm::dvec3& centre, uint64_t budget,
              std::span<const glm::dvec3> lamps = {}, double extent = 0);

/// Every node whole.
Cut full_cut(const NodeSource& source);

}  // namespace lucarne::octree
