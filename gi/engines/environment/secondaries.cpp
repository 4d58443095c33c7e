#include "gi/engines/environment/secondaries.h"

#include <algorithm>

#include "gi/gather/gather_point.h"

namespace lucarne::gi::environment {
namespace {

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

/// Marks sides of which everything below is known as means.
void Secondaries::find_means(const SurfelTree& tree) {
    for_each_upward(tree, [&](size_t node) {
        for (size_t side = 16 * node; side < 16 * node + 16; ++side) {
            State& state = states_[side];
            if (state == State::primary || state == State::copied) continue;
            size_t all = 0, known = 0;
            for_each_below(tree, side, [&](size_t below, float) {
                ++all;
                known += states_[below] != State::unknown;
            });
            if (all > 0 && known == all) state = State::mean;
        }
    });
}

size_t Secondaries::count_gathering() const {
    return static_cast<size_t>(std::count(states_.begin(), states_.end(), State::seen));
}

void Secondaries::choose(const SurfelTree& tree, std::span<const uint32_t> seen,
                         std::span<const uint32_t> primaries) {
    states_.assign(16 * tree.nodes.size(), State::unknown);
    primaries_.assign(primaries.begin(), primaries.end());
    gathering_.clear();
    for (const uint32_t code : seen)
        if (code < kSeesSky) states_[code] = State::seen;
    counts_.seen = count_gathering();
    const std::vector<State> marks = states_;
    find_means(tree);
    counts_.after_up = count_gathering();
    states_ = marks;
    for (const uint32_t side : primaries) states_[side] = State::primary;
    for_each_downward(tree, [&](size_t node) {
        for (size_t side = 16 * node; side < 16 * node + 16; ++side)
            if (states_[side] == State::primary || states_[side] == State::copied)
                for_each_below(tree, side, [&](size_t below, float) { states_[below] = State::copied; });
    });
    find_means(tree);
    for (size_t side = 0; side < states_.size(); ++side)
        if (states_[side] == State::seen) gathering_.push_back(static_cast<uint32_t>(side));
    counts_.after_down = gathering_.size();
}

void Secondaries::choose_all(const SurfelTree& tree) {
    states_.assign(16 * tree.nodes.size(), State::unknown);
    primaries_.clear();
    gathering_.clear();
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.surfels[slot] != kNoSurfel)
            for (const size_t side : {2 * slot, 2 * slot + 1}) {
                states_[side] = State::seen;
                gathering_.push_back(static_cast<uint32_t>(side));
            }
    counts_ = {gathering_.size(), gathering_.size(), gathering_.size()};
    find_means(tree);
}

std::vector<glm::vec3> Secondaries::propagate(const SurfelTree& tree, std::span<const glm::vec3> at_primaries,
                                              std::span<const glm::vec3> gathered) const {
    std::vector<glm::vec3> light(states_.size(), glm::vec3(0.0f));
    std::vector<uint8_t> known(states_.size(), 0);
    const auto set = [&](std::span<const uint32_t> sides, std::span<const glm::vec3> values) {
        for (size_t i = 0; i < sides.size(); ++i) {
            light[sides[i]] = values[i];
            known[sides[i]] = 1;
        }
    };
    set(primaries_, at_primaries);
    set(gathering_, gathered);
    const auto copy_down = [&](const auto& takes) {
        for_each_downward(tree, [&](size_t node) {
            for (size_t side = 16 * node; side < 16 * node + 16; ++side)
                if (known[side])
                    for_each_below(tree, side, [&](size_t below, float) {
                        if (known[below] || !takes(below)) return;
                        light[below] = light[side];
                        known[below] = 1;
                    });
        });
    };
    copy_down([&](size_t side) { return states_[side] == State::copied; });
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
    copy_down([](size_t) { return true; });
    return light;
}

}  // namespace lucarne::gi::environment
