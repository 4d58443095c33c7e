#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::io {

/// How far the cap of a 6-DoF controller is pushed and turned, as seen by who sits before it: shares of what
/// it can do, -1 to 1.
struct SixDofState {
    glm::dvec3 push{0.0};  ///< right, up, forward
    glm::dvec3 turn{0.0};  ///< nose up, nose left, right side down: counterclockwise about right and up,
                           ///< clockwise about forward as seen from behind
    uint32_t buttons = 0;  ///< bit i: button i is down

    bool at_rest() const { return push == glm::dvec3(0.0) && turn == glm::dvec3(0.0); }
    bool operator==(const SixDofState&) const = default;
};

/// Takes one HID report of a 3Dconnexion device, whose first byte is its number: 1 pushes (and, in newer
/// devices, turns behind them), 2 turns, 3 buttons; values are 16-bit little-endian, +-350 at full travel,
/// about axes to the right, toward the user and down. Others (batteries, displays) and cut off ones change
/// nothing: false.
bool take_report(std::span<const std::byte> report, SixDofState& state);

/// What of the device moves what, and how much: axes in the order right, up, forward, nose up, nose left,
/// right side down.
struct SixDofMapping {
    static constexpr size_t kAxes = 6;
    std::array<uint8_t, kAxes> from{0, 1, 2, 3, 4, 5};  ///< the device's axis that each one listens to
    std::array<double, kAxes> scale{1, 1, 1, 1, 1, 1};  ///< negative: the other way round; 0: not at all
    double sensitivity = 1;                             ///< of all
    double dead_zone = 0.05;  ///< share of the travel that is a hand's weight, 0 to .9

    bool operator==(const SixDofMapping&) const = default;
    /// The state with dead zone, mapping and sensitivity applied; still is 0 at rest, and without a step at
    /// the dead zone's edge. Buttons as they are.
    SixDofState apply(const SixDofState& state) const;
};

}  // namespace lucarne::io
