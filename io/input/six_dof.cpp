#include "io/input/six_dof.h"

#include <algorithm>
#include <cmath>

namespace lucarne::io {
namespace {

constexpr double kFullTravel = 350;
constexpr size_t kReportOfThree = 7, kReportOfSix = 13;

glm::dvec3 three(std::span<const std::byte> at) {
    glm::dvec3 values;
    for (size_t i = 0; i < 3; ++i) {
        const auto low = std::to_integer<uint16_t>(at[2 * i]),
                   high = std::to_integer<uint16_t>(at[2 * i + 1]);
        const auto raw = static_cast<int16_t>(static_cast<uint16_t>(low | high << 8));
        values[static_cast<int>(i)] = std::clamp(raw / kFullTravel, -1.0, 1.0);
    }
    return values;
}

/// Converts the device's axes (right, toward the user, down) to the user's.
glm::dvec3 push_of(const glm::dvec3& raw) {
    return {raw.x, -raw.z, -raw.y};
}
glm::dvec3 turn_of(const glm::dvec3& raw) {
    return {raw.x, -raw.z, -raw.y};
}

}  // namespace

bool take_report(std::span<const std::byte> report, SixDofState& state) {
    if (report.empty()) return false;
    switch (std::to_integer<int>(report[0])) {
        case 1:
            if (report.size() < kReportOfThree) return false;
            state.push = push_of(three(report.subspan(1)));
            if (report.size() >= kReportOfSix) state.turn = turn_of(three(report.subspan(7)));
            return true;
        case 2:
            if (report.size() < kReportOfThree) return false;
            state.turn = turn_of(three(report.subspan(1)));
            return true;
        case 3: {
            if (report.size() < 2) return false;
            uint32_t buttons = 0;
            for (size_t i = 1; i < std::min<size_t>(report.size(), 5); ++i)
                buttons |= std::to_integer<uint32_t>(report[i]) << (8 * (i - 1));
            state.buttons = buttons;
            return true;
        }
        default:
            return false;
    }
}

SixDofState SixDofMapping::apply(const SixDofState& state) const {
    const double dead = std::clamp(dead_zone, 0.0, 0.9);
    const auto axis = [&](size_t i) {
        const size_t source = std::min<size_t>(from[i], kAxes - 1);
        const double value =
            source < 3 ? state.push[static_cast<int>(source)] : state.turn[static_cast<int>(source - 3)];
        const double beyond = std::max(std::abs(value) - dead, 0.0) / (1 - dead);
        return std::copysign(beyond, value) * scale[i] * sensitivity;
    };
    return {{axis(0), axis(1), axis(2)}, {axis(3), axis(4), axis(5)}, state.buttons};
}

}  // namespace lucarne::io
