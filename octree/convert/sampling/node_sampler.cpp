#include "octree/convert/sampling/node_sampler.h"

#include <algorithm>
#include <cassert>

#include "octree/tree/area_floor.h"

namespace lucarne::octree {

void NodeSampler::start(const NodeKey& parent) {
    parent_ = parent;
    sampler_.start(parent);
    areas_.clear();
    children_.clear();
}

void NodeSampler::add(const Place& place, float area) {
    sampler_.add(place);
    areas_.push_back(area);
}

void NodeSampler::end_child(const Pending& child) {
    assert(children_.empty() || children_.back().node.key < child.key);
    assert(child.key == parent_ || child.key.parent() == parent_);
    children_.push_back({child, children_.empty() ? 0 : children_.back().end, sampler_.size(), 0});
}

void NodeSampler::run() {
    sampler_.run(kNodeSpacing, std::min(limits_.sample, std::max<size_t>(1, sampler_.size() * 3 / 8)));
    first_own_pass_ = 1;
    count_taken();
}

void NodeSampler::run_root() {
    sampler_.run(kRootSpacing, sampler_.size());
    first_own_pass_ = 0;
    count_taken();
}

void NodeSampler::count_taken() {
    for (auto& child : children_) {
        const auto passes = sampler_.passes().subspan(child.begin, child.end - child.begin);
        child.taken = static_cast<size_t>(std::count_if(
            passes.begin(), passes.end(), [&](uint8_t pass) { return pass < first_own_pass_; }));
    }
}

void NodeSampler::taken(size_t child, std::vector<uint32_t>& indices) const {
    const Child& c = children_[child];
    indices.clear();
    for (size_t i = c.begin; i < c.end; ++i)
        if (sampler_.passes()[i] < first_own_pass_) indices.push_back(static_cast<uint32_t>(i - c.begin));
}

void NodeSampler::kept(size_t child, std::vector<uint32_t>& indices, std::vector<uint8_t>& passes) const {
    const Child& c = children_[child];
    indices.clear();
    passes.clear();
    for (size_t i = c.begin; i < c.end; ++i) {
        const uint8_t pass = sampler_.passes()[i];
        if (pass < first_own_pass_) continue;
        indices.push_back(static_cast<uint32_t>(i - c.begin));
        passes.push_back(pass);
    }
}

format::Entry NodeSampler::settle(size_t child, std::vector<uint32_t>& order) {
    const Child& c = children_[child];
    order.clear();
    append_prefix_order(sampler_.passes().subspan(c.begin, c.end - c.begin), first_own_pass_, order);
    inherited_.clear();
    own_.clear();
    for (size_t i = c.begin; i < c.end; ++i)
        if (sampler_.passes()[i] < first_own_pass_) inherited_.push_back(areas_[i]);
    for (const uint32_t i : order) own_.push_back(areas_[c.begin + i]);
    format::Entry entry;
    assert(own_.size() == c.end - c.begin - c.taken && c.taken <= c.node.points);
    entry.key = c.node.key;
    entry.child_mask = c.node.child_mask;
    entry.count = static_cast<uint32_t>(order.size());
    entry.subtree_count = c.node.points - c.taken;
    entry.area_floor = stored_floors(area_floors(inherited_, own_, c.node.surface), face_edge_);
    return entry;
}

Pending NodeSampler::parent() const {
    Pending parent{.key = parent_};
    for (const auto& child : children_) {
        if (child.node.points > child.taken)
            parent.child_mask |= static_cast<uint8_t>(1u << child.node.key.octant());
        parent.points += child.node.points;
        parent.surface += child.node.surface;
    }
    return parent;
}

}  // namespace lucarne::octree
