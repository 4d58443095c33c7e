#pragma once

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <new>
#include <set>
#include <vector>

#include "octree/tree/source.h"

namespace lucarne::octree::test {

/// The nodes of an evenly scanned square: a quadtree of `levels` levels in the z = 0 layer of an octree.
/// Every node is in its parent's lower half and has `count` points of its own. 16 bytes a point.
class PlaneSource : public NodeSource {
 public:
    PlaneSource(uint32_t levels, uint32_t count, double size) {
        header_.schema.stride = 16;
        header_.root = {glm::dvec3(0.0), size};
        header_.max = {size, size, 0.0};
        nodes_.reserve(((size_t{1} << 2 * levels) - 1) / 3);
        NodeInfo root;
        root.first_child = levels > 1 ? 1 : kNoNode;
        root.child_mask = levels > 1 ? 0x0f : 0;
        nodes_.push_back(root);
        for (uint32_t node = 0; node < nodes_.size(); ++node) {
            if (nodes_[node].child_mask == 0) continue;
            nodes_[node].first_child = static_cast<uint32_t>(nodes_.size());
            for (uint32_t octant = 0; octant < 4; ++octant) {
                NodeInfo child;
                child.key = nodes_[node].key.child(octant);
                child.parent = node;
                child.child_mask = child.key.level + 1 < levels ? 0x0f : 0;
                nodes_.push_back(child);
            }
        }
        for (NodeInfo& node : nodes_) {
            node.count = count;
            const double side = header_.root.of(node.key).size;
            // The node's own points and the ancestors' in this square: count (1 + 1/4 + 1/16 + ...).
            double points = 0;
            for (uint32_t level = 0; level <= node.key.level; ++level)
                points += count * std::pow(0.25, node.key.level - level);
            for (size_t step = 0; step < kPrefixSteps; ++step)
                node.area_floor[step] =
                    static_cast<float>(side * side / (points - count + count / double(1 << step)));
            header_.points += count;
        }
    }

    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return nodes_; }
    std::vector<NodeInfo>& edit() { return nodes_; }

    /// Every byte of a node is the low byte of its index. Loading waits while the gate is closed.
    Result<NodeData> load(uint32_t node) const override {
        std::unique_lock lock(mutex_);
        order_.push_back(node);
        ++waiting_;
        changed_.notify_all();
        changed_.wait(lock, [&] { return open_; });
        --waiting_;
        if (broken_.contains(node)) return rejected("plane", "node is broken");
        if (throwing_.contains(node)) throw std::bad_alloc();
        const uint32_t count = nodes_[node].count - (short_.contains(node) ? 1 : 0);
        return NodeData{count, std::vector<std::byte>(size_t{count} * 16, static_cast<std::byte>(node))};
    }

    void shut() { set_gate(false); }
    void open() { set_gate(true); }
    /// Waits until `loads` loads wait at the gate.
    void await(size_t loads) const {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return waiting_ >= loads; });
    }
    void break_node(uint32_t node) { broken_.insert(node); }
    void mend_node(uint32_t node) { broken_.erase(node); }
    void throw_at(uint32_t node) { throwing_.insert(node); }
    void shorten(uint32_t node) { short_.insert(node); }
    std::vector<uint32_t> order() const {
        const std::lock_guard lock(mutex_);
        return order_;
    }

 private:
    void set_gate(bool open) {
        const std::lock_guard lock(mutex_);
        open_ = open;
        changed_.notify_all();
    }

    SourceHeader header_;
    std::vector<NodeInfo> nodes_;
    std::set<uint32_t> broken_, throwing_, short_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable std::vector<uint32_t> order_;
    mutable size_t waiting_ = 0;
    bool open_ = true;
};

}  // namespace lucarne::octree::test
