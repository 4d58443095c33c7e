#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/cache/format.h"
#include "octree/convert/sampling/sampler.h"

namespace lucarne::octree {

/// An inner node's spacing in cube sizes: a plane through the cube then shows some 12000 points.
inline constexpr float kNodeSpacing = 1.0f / 128;
/// The root has no parent whose sample its prefix could continue: its order starts at 1/64 of its points.
inline constexpr float kRootSpacing = 8 * kNodeSpacing;

/// How large nodes get. Depends on the record's size alone, so that the tree does not depend on --memory.
struct NodeLimits {
    explicit NodeLimits(uint32_t stride)
        : leaf(std::clamp<size_t>((size_t{512} << 10) / stride, 8, 10'000)), sample(2 * leaf) {}
    size_t leaf;    ///< a cube with more points is split
    size_t sample;  ///< most points that an inner node shows, its ancestors' among them
};

/// A node that is whole but for what its parent will take: the points it shows are its sample.
struct Pending {
    NodeKey key;
    uint8_t child_mask = 0;
    uint64_t points = 0;  ///< in the cube in all, whichever node will hold them
    double surface = 0;   ///< in the cube, in faces of the root cube before it was doubled
};

/// Divides the samples of up to eight children between them and their parent. Areas and surfaces count in
/// faces of the root cube before it was doubled, whose edge is `face_edge`: in squares of the unit, floats
/// would not hold those of every cloud. Only the floors of a directory entry are in squares of the unit.
class NodeSampler {
 public:
    NodeSampler(const NodeLimits& limits, double face_edge) : limits_(limits), face_edge_(face_edge) {}

    void start(const NodeKey& parent);
    void add(const Place& place, float area);  ///< the samples of one child, in Morton order...
    void end_child(const Pending& child);      ///< ...and then the child; children in octant order
    void run();
    /// For the root, as its own only child: nothing is taken from it, its points are only ordered.
    void run_root();

    size_t children() const { return children_.size(); }
    /// Which of a child's sample the parent takes, ascending.
    void taken(size_t child, std::vector<uint32_t>& indices) const;
    /// Which of it stays, in prefix order, and the child's directory entry but for its payload.
    format::Entry settle(size_t child, std::vector<uint32_t>& order);
    /// Which of a child's sample stays, ascending, and the pass of each: what `settle` orders.
    void kept(size_t child, std::vector<uint32_t>& indices, std::vector<uint8_t>& passes) const;
    /// The parent, with those of its children that kept any point.
    Pending parent() const;

 private:
    struct Child {
        Pending node;
        size_t begin = 0, end = 0;  ///< its sample among the points
        size_t taken = 0;
    };
    void count_taken();

    NodeLimits limits_;
    double face_edge_;
    NodeKey parent_;
    Sampler sampler_;
    std::vector<float> areas_;
    std::vector<Child> children_;
    uint8_t first_own_pass_ = 1;
    std::vector<float> inherited_, own_;
};

}  // namespace lucarne::octree
