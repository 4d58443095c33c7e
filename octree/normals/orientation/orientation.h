#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/orientation/shell.h"
#include "octree/normals/orientation/signed_forest.h"
#include "octree/normals/surface/chunk_surface.h"

namespace lucarne::octree {

/// How two normals at the ends of an edge agree (Hoppe et al. 1992, section 3.3).
struct Agreement {
    bool opposite = false;  ///< one of them must be turned
    float doubt = 1.0f;     ///< 1 - |agreement|: the cost of the edge in the spanning tree, 0 to 1
};
/// Nearly parallel normals are compared as they are, unless one point lies over the other: the two faces of a
/// thin wall and the noise of one face look alike there, and no witness (doubt 1) is better than a false one.
/// Where the surface turns between the points, one normal is first mirrored in the plane half-way between
/// them, so that going round a sharp edge costs nothing and keeps the outside outside (Xie, Wang, Hua, Qin,
/// Kaufman 2003).
Agreement agreement(const glm::vec3& normal, const glm::vec3& other, const glm::vec3& offset);

/// The orientation of one chunk's sites among themselves.
struct ChunkOrientation {
    std::vector<uint32_t> components;  ///< of each site; sites without a normal are in 0
    uint32_t count = 1;                ///< components
    bool anchored = false;             ///< component 0 is turned toward the stations already
};

/// Hands orientation on along a minimum spanning forest of the neighbourhood graph: edge by edge on smooth
/// surfaces; between these by the votes of all edges, since at creases a single edge is a poor witness. Turns
/// `surface.normals` accordingly: consistent within each component. `toward[site]` is +1 where the normal is
/// known to point toward its station as it is, -1 where it must be turned, 0 where nothing is known.
ChunkOrientation orient_chunk(const ChunkNeighbours& neighbours, ChunkSurface& surface,
                              std::span<const int8_t> toward);

/// Joins the components of all chunks: a signed graph whose edges are votes of point pairs across chunk
/// borders, and its maximum spanning forest. Takes the chunks in ascending order; holds what unfinished
/// chunks must still hear from finished ones (kVotesPerPair edges a pair of component and chunk at most), and
/// a few words a component.
class OrientationMerger {
 public:
    explicit OrientationMerger(size_t chunks) : inboxes_(chunks), first_component_(1, 0) {}

    /// `site_of` gives the site of each point of the chunk. Chunks without points are added, too.
    void add(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
             const ChunkOrientation& orientation);
    void add_empty();

    /// +1 keep or -1 turn, for every chunk and component. Components that no station anchors are turned as a
    /// whole, so that the normal at the topmost point of each connected surface points up: true of whatever
    /// was scanned from outside or above.
    std::vector<std::vector<int8_t>> signs() const;

 private:
    struct Message {  ///< an edge seen from the finished chunk
        uint32_t component, index;
        glm::vec3 normal, offset;
    };
    struct Component {
        Shell shell;
        bool anchored = false;
    };
    void hear(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
              const ChunkOrientation& orientation);
    void tell(const ChunkSurface& surface, const ChunkOrientation& orientation);

    std::vector<std::vector<Message>> inboxes_;
    std::vector<uint32_t> first_component_;  ///< of each chunk added so far, and one more
    std::vector<Component> components_;
    SignVotes votes_;  ///< between components
};

}  // namespace lucarne::octree
