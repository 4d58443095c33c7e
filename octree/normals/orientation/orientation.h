#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/orientation/shell.h"
#include "octree/normals/orientation/signed_forest.h"
#include "octree/normals/surface/chunk_surface.h"

namespace lucarne::octree {

/// How the normals at the two ends of an edge agree (Hoppe et al. 1992, section 3.3).
struct Agreement {
    bool opposite = false;  ///< one of them must be flipped
    float doubt = 1.0f;     ///< 1 - |agreement|: the cost of the edge in the spanning tree, 0 to 1
};
/// Compares two normals. Nearly parallel normals are compared directly, unless one point lies over the other:
/// there the two faces of a thin wall and the noise of one face look alike, and ignoring the edge (doubt 1)
/// is better than trusting it. Where the surface turns between the points, one normal is first mirrored in
/// the plane half-way between them. Then a sharp edge costs nothing to cross, and the outside stays outside
/// (Xie, Wang, Hua, Qin, Kaufman 2003).
Agreement agreement(const glm::vec3& normal, const glm::vec3& other, const glm::vec3& offset);

/// The orientation of one chunk's sites relative to each other.
struct ChunkOrientation {
    std::vector<uint32_t> components;  ///< component of each site; sites without a normal have 0
    uint32_t count = 1;                ///< number of components
    bool anchored = false;             ///< component 0 already faces the stations
};

/// Propagates orientation along a minimum spanning forest of the neighbourhood graph. On smooth surfaces it
/// follows single edges. Between smooth pieces all edges vote, because at creases a single edge is
/// unreliable. Flips `surface.normals` so that they are consistent within each component. `toward[site]` is
/// +1 where the normal is known to point toward its station, -1 where it must be flipped, 0 where nothing is
/// known.
ChunkOrientation orient_chunk(const ChunkNeighbours& neighbours, ChunkSurface& surface,
                              std::span<const int8_t> toward);

/// Joins the components of all chunks: builds a signed graph whose edges are votes of point pairs across
/// chunk borders, and its maximum spanning forest. Takes the chunks in ascending order. Holds the messages
/// from finished chunks to unfinished ones (at most kVotesPerPair edges a pair of component and chunk), and a
/// few words a component.
class OrientationMerger {
 public:
    explicit OrientationMerger(size_t chunks) : inboxes_(chunks), first_component_(1, 0) {}

    /// Adds the next chunk. Chunks without points must be added, too, by add_empty().
    void add(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
             const ChunkOrientation& orientation);
    void add_empty();

    /// Returns +1 (keep) or -1 (flip) for every chunk and component. Connected surfaces that no station
    /// anchors are flipped as a whole to face the side that was seen, which their shape tells (Shell).
    std::vector<std::vector<int8_t>> signs() const;

 private:
    struct Message {  ///< an edge, as the finished chunk sees it
        uint32_t component, index;
        glm::vec3 normal, offset;
    };
    struct Component {
        Shell shell;
        bool anchored = false;
    };
    /// Turns the messages for this chunk into votes.
    void hear(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
              const ChunkOrientation& orientation);
    /// Sends the chunk's border edges as messages to the chunks that come later.
    void tell(const ChunkSurface& surface, const ChunkOrientation& orientation);

    std::vector<std::vector<Message>> inboxes_;  ///< messages to each chunk that is not yet added
    std::vector<uint32_t> first_component_;      ///< of each chunk added so far, and the end
    std::vector<Component> components_;
    SignVotes votes_;  ///< between components
};

}  // namespace lucarne::octree
