#include "gi/engines/environment/secondaries.h"

#include <algorithm>

#include "gi/engines/environment/primaries.h"
#include "gi/gather/gather_point.h"
#include "gi/shared/surfel.h"

namespace lucarne::gi::environment {
namespace {

/// Slots may be thick for a share of the size up to which their parts have one light. The upper side of a
/// pipe below a ceiling is dark, and that of the ceiling is lit by the sky: where both were one back, rooms
/// shone blue beside pipes and beams.
constexpr float kThickest = 1.0f / 6;

/// Calls body(child side, weight) for those sides below a side of which it is the mean.
template <class Body>
void for_each_below(const SurfelTree& tree, size_t side, const Body& body) {
    const bool back = (side & 1) != 0;
    for_each_child(tree, side / 2, [&](size_t child) {
        const Facing share = facing(tree, side / 2, child);
        const float weight = back ? share.back : share.front;
        if (weight > 0) body(2 * child + (share.same == back ? 1 : 0), weight);
    });
}

}  // namespace

/// Marks sides of which everything below is known as means, and collects those that are not.
void Secondaries::find_means(const SurfelTree& tree) {
    for_each_upward(tree, [&](size_t node) {
        for (size_t side = 16 * node; side < 16 * node + 16; ++side) {
            if (states_[side] == State::part) continue;
            size_t all = 0, known = 0;
            for_each_below(tree, side, [&](size_t below, float) {
                ++all;
                known += states_[below] == State::seen || states_[below] == State::mean;
            });
            if (all > 0 && known == all) states_[side] = State::mean;
        }
    });
    sides_.clear();
    for (size_t side = 0; side < states_.size(); ++side)
        if (states_[side] == State::seen) sides_.push_back(static_cast<uint32_t>(side));
}

void Secondaries::choose(const SurfelTree& tree, std::span<const uint32_t> seen,
                         const std::function<bool(size_t)>& fine) {
    states_.assign(16 * tree.nodes.size(), State::unknown);
    for (const uint32_t code : seen)
        if (code < kSeesSky) states_[code] = State::seen;
    seen_ = static_cast<size_t>(std::count(states_.begin(), states_.end(), State::seen));
    // What is seen of a fine slot's parts is asked of the largest fine slot that they are part of.
    for_each_upward(tree, [&](size_t node) {
        for (size_t slot = 8 * node; slot < 8 * node + 8; ++slot) {
            if (tree.nodes[node].child[slot % 8] < 0 || !fine(slot)) continue;
            for (const size_t side : {2 * slot, 2 * slot + 1})
                for_each_below(tree, side, [&](size_t below, float) {
                    if (states_[below] == State::seen) states_[side] = State::seen;
                    states_[below] = State::part;
                });
        }
    });
    find_means(tree);
}

void Secondaries::choose_all(const SurfelTree& tree) {
    states_.assign(16 * tree.nodes.size(), State::unknown);
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.surfels[slot] != kNoSurfel) states_[2 * slot] = states_[2 * slot + 1] = State::seen;
    seen_ = 2 * tree.leaves;
    find_means(tree);
}

std::vector<glm::vec3> Secondaries::propagate(const SurfelTree& tree,
                                              std::span<const glm::vec3> known_light) const {
    std::vector<glm::vec3> light(states_.size(), glm::vec3(0.0f));
    std::vector<uint8_t> known(states_.size(), 0);
    for (size_t i = 0; i < sides_.size(); ++i) {
        light[sides_[i]] = known_light[i];
        known[sides_[i]] = 1;
    }
    for_each_upward(tree, [&](size_t node) {
        for (size_t side = 16 * node; side < 16 * node + 16; ++side) {
            if (known[side]) continue;
            glm::vec3 sum(0.0f);
            float weights = 0;
            for_each_below(tree, side, [&](size_t below, float weight) {
                if (!known[below]) return;
                sum += weight * light[below];
                weights += weight;
            });
            if (!(weights > 0)) continue;
            light[side] = sum / weights;
            known[side] = 1;
        }
    });
    for_each_downward(tree, [&](size_t node) {
        for (size_t side = 16 * node; side < 16 * node + 16; ++side)
            if (known[side])
                for_each_below(tree, side, [&](size_t below, float) {
                    if (known[below]) return;
                    light[below] = light[side];
                    known[below] = 1;
                });
    });
    return light;
}

bool shares_light(const SurfelTree& tree, size_t slot, const CameraView& camera, float spacing) {
    return is_fine(tree, slot, camera, spacing, tree.nodes[slot / 8].thickness[slot % 8] / kThickest);
}

}  // namespace lucarne::gi::environment
