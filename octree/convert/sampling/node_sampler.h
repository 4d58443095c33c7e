#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/cache/format.h"
#include "octree/convert/sampling/sampler.h"

namespace lucarne::octree {

/// An inner node's spacing in cube sizes. A plane through the cube then has about 12000 points.
inline constexpr float kNodeSpacing = 1.0f / 128;
/// The root has no parent whose sample its prefix could continue, so its order starts at 1/64 of its points.
inline constexpr float kRootSpacing = 8 * kNodeSpacing;

/// Limits of the size of nodes. They depend on the record's size alone, so the tree does not depend on
/// --memory.
struct NodeLimits {
    explicit NodeLimits(uint32_t stride)
        : leaf(std::clamp<size_t>((size_t{512} << 10) / stride, 8, 10'000)), sample(2 * leaf) {}
    size_t leaf;    ///< a cube with more points is split
    size_t sample;  ///< most points that an inner node shows, including its ancestors'
};

/// A node that is complete except for the points that its parent will take. The points it shows are its
/// sample.
struct Pending {
    NodeKey key;
    uint8_t child_mask = 0;
    uint64_t points = 0;  ///< all points in the cube, whichever node will hold them
    double surface = 0;   ///< in the cube, in faces of the root cube before it was doubled
};

/// Divides the samples of up to eight children between them and their parent. Areas and surfaces are in faces
/// of the root cube before it was doubled, whose edge is `face_edge`, because floats cannot represent those
/// of every cloud in squares of the unit. Only the floors of a directory entry are in squares of the unit.
class NodeSampler {
 public:
    NodeSampler(const NodeLimits& limits, double face_edge) : limits_(limits), face_edge_(face_edge) {}

    void start(const NodeKey& parent);
    void add(const Place& place, float area);  ///< call for the sample of one child, in Morton order...
    void end_child(const Pending& child);      ///< ...and then for the child; children in octant order
    void run();
    /// Handles the root, as its own only child: takes no points from it, only orders them.
    void run_root();

    size_t children() const { return children_.size(); }
    /// Lists which points of a child's sample the parent takes, ascending.
    void taken(size_t child, std::vector<uint32_t>& indices) const;
    /// Lists which points stay with the child, in prefix order. Returns the child's directory entry without
    /// its payload.
    format::Entry settle(size_t child, std::vector<uint32_t>& order);
    /// Lists which points stay with the child, ascending, and the pass of each, from which `settle` makes the
    /// order.
    void kept(size_t child, std::vector<uint32_t>& indices, std::vector<uint8_t>& passes) const;
    /// Returns the parent, with a child mask of those children that kept any point.
    Pending parent() const;

 private:
    struct Child {
        Pending node;
        size_t begin = 0, end = 0;  ///< range of its sample among the points
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
