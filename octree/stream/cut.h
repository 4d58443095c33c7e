#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// A node of a cut and how many of its points, counted from the first, are drawn.
struct CutNode {
    uint32_t node = 0;
    uint32_t count = 0;
    /// What loading the node adds to the picture per point: the pixels that it covers times the pixels by
    /// which the points' spacing falls there. Nodes of larger priority are loaded sooner.
    float priority = 0;
};

/// The nodes selected for a purpose: closed under parents, sorted by node index. All nodes except the cut's
/// leaves are drawn whole; the level of detail fades in through the prefixes of the leaves.
struct Cut {
    std::vector<CutNode> nodes;
    uint64_t points = 0;
    uint64_t visited = 0;     ///< nodes examined by the selection
    bool budget_hit = false;  ///< the wanted spacing was not reached everywhere
};

/// A pinhole view for the selection of nodes, in world units (the file's).
struct View {
    glm::dvec3 position{0.0}, forward{0.0, 1.0, 0.0}, right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0};  ///< unit axes
    double tan_half_width = 1, tan_half_height = 1;
    uint32_t width = 1, height = 1;  ///< pixels or shadow-map texels
    double near_plane = 1e-3;
    /// Whether to draw anything in a cube; empty: draw everything.
    std::function<bool(const Cube&)> wanted{};
};

/// Selects what a camera sees. Refines where the projected spacing of the points is largest, until it is
/// below `pixel_spacing` pixels everywhere or `budget` points are taken. Culls nodes outside the view. A node
/// fades in by its prefix between the distance where its parent's spacing is too wide and the distance where
/// its own is just fine enough. A move that changes a node's distance by a small share e changes its prefix
/// by at most 10 e of its count (while the budget is not hit). A larger budget never makes any place coarser.
Cut view_cut(const NodeSource& source, const View& view, uint64_t budget, double pixel_spacing = 1.0);

/// Does the same for a light view (a shadow map or light G-buffer). Receivers must not be finer than casters,
/// so the cut follows the spacing seen from the light.
Cut light_view_cut(const NodeSource& source, const View& light, uint64_t budget, double texel_spacing = 1.0);

/// Selects what may bounce or block light: everything, visible or not, refined toward `centre` (the camera's
/// focus) in proportion to distance, as fine as `budget` allows. The cut is refined toward `lamps` too:
/// surfels close to a lamp cast large shadows of their discs' rims, and a wall close to it receives most of
/// its light. `extent` is the extent of the robust bounds (octree/tree/robust_bounds.h) in world units where
/// these are smaller than the scene; 0: the whole scene's.
Cut light_cut(const NodeSource& source, const glm::dvec3& centre, uint64_t budget,
              std::span<const glm::dvec3> lamps = {}, double extent = 0);

/// Selects every node, whole.
Cut full_cut(const NodeSource& source);

}  // namespace lucarne::octree
