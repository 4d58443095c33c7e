#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/normals/orientation/patches.h"
#include "octree/normals/orientation/shell.h"
#include "octree/normals/orientation/sight.h"
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
    std::vector<PatchVote> votes;      ///< between the components
};

/// How finely the orientation is asked, which depends on the number of points of the whole cloud.
struct OrientationDetail {
    size_t patch = 64;  ///< sites of a patch
    size_t disc = 1;    ///< sites for which a SightDisc stands
    /// So many patches and discs in all as take a small part of the memory, and some ten thousand at most.
    static OrientationDetail of(const ChunkAccess& chunks, uint64_t memory);
};

/// Propagates orientation along a minimum spanning forest of the neighbourhood graph. On smooth surfaces it
/// follows single edges. Between smooth pieces all edges vote, because at creases a single edge is
/// unreliable. Where no station anchors the chunk, its components are patches, between which all edges vote
/// again, together with what sees each other (vote_by_sight). Flips `surface.normals` so that they are
/// consistent within each component. `toward[site]` is +1 where the normal is known to point toward its
/// station, -1 where it must be flipped, 0 where nothing is known.
ChunkOrientation orient_chunk(const ChunkNeighbours& neighbours, ChunkSurface& surface,
                              std::span<const int8_t> toward, const OrientationDetail& detail);

/// A vote on how a component of one chunk agrees with one of an earlier chunk: the sum over the pairs of
/// points that stand for them.
struct ComponentVote {
    uint32_t chunk = 0, component = 0;  ///< the earlier one
    uint32_t own = 0;                   ///< the component of the chunk that has the vote
    double same = 0;                    ///< > 0: the same orientation
};

/// What one chunk contributes to the orientation of all.
struct ChunkVotes {
    struct Component {
        Shell shell;
        bool anchored = false;
    };
    std::vector<Component> components;
    std::vector<ComponentVote> votes;
    std::vector<SightDisc> discs;  ///< their components are those of the chunk
};

/// Sums up the votes of a chunk by pairs of components, in the order in which the pairs come.
class VoteSums {
 public:
    void add(const ComponentVote& vote);
    std::vector<ComponentVote> take() { return std::move(votes_); }

 private:
    std::vector<ComponentVote> votes_;
    std::map<std::tuple<uint32_t, uint32_t, uint32_t>, size_t> index_;  ///< in votes_, by components
};

/// An edge between two chunks, as the earlier one sees it.
struct BorderMessage {
    uint32_t chunk, component;  ///< where it comes from
    uint32_t to, index;         ///< the point in the later chunk
    glm::vec3 normal, offset;

    /// Returns the vote of the later chunk, where the point has a `normal` and belongs to `own`.
    ComponentVote heard(const glm::vec3& other, uint32_t own) const;
};

/// Carries the border edges of finished chunks to later ones. Takes the chunks of one process in ascending
/// order. Holds the messages from finished chunks to unfinished ones (at most kVotesPerPair edges a pair of
/// component and chunk).
class BorderMail {
 public:
    /// Chunks from `end` on belong to other processes.
    BorderMail(size_t end, const OrientationDetail& detail) : inboxes_(end), detail_(detail) {}

    /// Finishes a chunk.
    ChunkVotes finish(uint32_t chunk, const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                      const ChunkOrientation& orientation);
    /// Returns the messages to chunks from `end` on, in the order of the chunks that sent them.
    std::vector<BorderMessage> take_outgoing() { return std::move(outgoing_); }

 private:
    /// Returns discs that stand for the sites.
    std::vector<SightDisc> discs(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                                 const ChunkOrientation& orientation) const;
    /// Turns the messages for this chunk into votes.
    std::vector<ComponentVote> hear(uint32_t chunk, const ChunkNeighbours& neighbours,
                                    const ChunkSurface& surface, const ChunkOrientation& orientation);
    /// Sends the chunk's border edges as messages to the chunks that come later.
    void tell(uint32_t chunk, const ChunkSurface& surface, const ChunkOrientation& orientation);

    std::vector<std::vector<BorderMessage>> inboxes_;  ///< messages to each chunk that is not finished
    std::vector<BorderMessage> outgoing_;
    OrientationDetail detail_;
};

/// Joins the components of all chunks: builds a signed graph of their votes, and its maximum spanning forest.
/// Holds a few words a component, and the discs.
class OrientationMerger {
 public:
    explicit OrientationMerger(const OrientationDetail& detail) : detail_(detail) {}

    /// Adds the next chunk, in ascending order. A chunk without points has no components.
    void add(const ChunkVotes& chunk);

    /// Returns for every chunk and component whether it has to be flipped. Connected surfaces that no station
    /// anchors are flipped as a whole to face the side that was seen, which their shape tells (Shell).
    /// Call once.
    OrientationSigns signs();

 private:
    /// Whether no station tells which side was seen of a part of the surface that counts.
    bool in_doubt() const;
    /// Returns for each root of `forest` whether its shapes say that it is inside out. Each connected surface
    /// has a say: two rooms that see each other's outer sides do not look like a room together. `surfaces`:
    /// the components that edges connect.
    std::vector<bool> inside_out(SignedForest& forest, SignedForest& surfaces) const;

    std::vector<uint32_t> first_component_{0};  ///< of each chunk added so far, and the end
    std::vector<ChunkVotes::Component> components_;
    SignVotes votes_;  ///< between components
    OrientationDetail detail_;
    std::vector<SightDisc> discs_;
};

}  // namespace lucarne::octree
