#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/volume/space.h"

namespace lucarne::gi::volume {

/// Which cells of air see each other: remembers answers, because pixels beside each other ask the same.
class Sights {
 public:
    /// `space` must live as long as this.
    explicit Sights(const Space& space) : space_(space) {}

    /// Returns whether nothing is between the middles of two cells; the first is air and in the grid.
    bool see(const glm::ivec3& from, const glm::ivec3& to) {
        const glm::ivec3 away = glm::abs(to - from);
        // There is no wall between neighbours that are air (gi/volume/README.md).
        if (std::max({away.x, away.y, away.z}) <= 1) return true;
        const auto find = [&] { return space_.air.sees(glm::vec3(from) + 0.5f, glm::vec3(to) + 0.5f); };
        const Grid& grid = space_.grid();
        if (!grid.holds(to)) return find();
        const uint64_t pair = (uint64_t{grid.number(from)} << 32 | grid.number(to)) + 1;
        Answer& answer = answers_[pair * kGoldenRatio >> (64 - kBits)];
        if (answer.pair != pair) answer = {pair, find()};
        return answer.sees;
    }

 private:
    static constexpr int kBits = 10;
    static constexpr uint64_t kGoldenRatio =
        0x9e3779b97f4a7c15;  // Knuth 1998, section 6.4: Fibonacci hashing
    struct Answer {
        uint64_t pair = 0;  ///< 0: none
        bool sees = false;
    };

    const Space& space_;
    std::array<Answer, size_t{1} << kBits> answers_{};
};

}  // namespace lucarne::gi::volume
