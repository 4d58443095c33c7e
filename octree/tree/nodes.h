#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "octree/tree/key.h"

namespace lucarne::octree {

inline constexpr uint32_t kNoNode = UINT32_MAX;
inline constexpr size_t kPrefixSteps = 4;  ///< prefixes of 1, 1/2, 1/4, 1/8

/// What is known about a node without loading its points.
struct NodeInfo {
    NodeKey key;
    uint32_t parent = kNoNode;
    uint32_t first_child = kNoNode;  ///< children are contiguous in the directory, in octant order
    uint8_t child_mask = 0;          ///< bit i: the child in octant i exists
    uint32_t count = 0;              ///< points in this node itself
    uint64_t subtree_count = 0;      ///< points with all descendants
    uint32_t payload_bytes = 0;      ///< on disk
    /// Least surface share of a surfel (in square file units) where this node is the deepest of a cut and the
    /// first count/2^i of its points are drawn. See octree/tree/footprint.h.
    std::array<float, kPrefixSteps> area_floor{};

    /// The child in octant `o`, or kNoNode.
    uint32_t child(uint32_t o) const {
        if (!(child_mask >> o & 1)) return kNoNode;
        return first_child + static_cast<uint32_t>(__builtin_popcount(child_mask & ((1u << o) - 1)));
    }
    /// The mean distance between neighbouring points when all of the node's points are drawn, in the file's
    /// unit.
    float spacing() const { return __builtin_sqrtf(area_floor[0]); }
};

/// Hands out nodes of a directory that is not whole in memory. Thread-safe.
class NodePages {
 public:
    virtual ~NodePages() = default;
    /// A node without points and children if its page cannot be read.
    virtual NodeInfo node(uint32_t index) const = 0;
};

/// The nodes of a source by their number: an array, or pages that are read when they are looked at. A cheap
/// copy; valid as long as its source.
class NodeTable {
 public:
    NodeTable() = default;
    NodeTable(std::span<const NodeInfo> nodes) : nodes_(nodes.data()), size_(nodes.size()) {}
    NodeTable(const std::vector<NodeInfo>& nodes) : NodeTable(std::span(nodes)) {}
    NodeTable(const NodePages& pages, size_t size) : pages_(&pages), size_(size) {}

    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    NodeInfo operator[](size_t index) const {
        return pages_ ? pages_->node(static_cast<uint32_t>(index)) : nodes_[index];
    }

    NodeInfo back() const { return (*this)[size_ - 1]; }

    class Iterator {
     public:
        using iterator_category = std::input_iterator_tag;
        using value_type = NodeInfo;
        using difference_type = std::ptrdiff_t;
        using pointer = const NodeInfo*;
        using reference = NodeInfo;
        Iterator(const NodeTable& table, size_t index) : table_(&table), index_(index) {}
        NodeInfo operator*() const { return (*table_)[index_]; }
        Iterator& operator++() {
            ++index_;
            return *this;
        }
        bool operator==(const Iterator& other) const { return index_ == other.index_; }

     private:
        const NodeTable* table_;
        size_t index_;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size_}; }

 private:
    const NodeInfo* nodes_ = nullptr;
    const NodePages* pages_ = nullptr;
    size_t size_ = 0;
};

}  // namespace lucarne::octree
