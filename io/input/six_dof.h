#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::io {

/// How far the cap of a 6-DoF controller is pushed and turned, as seen by the user in front of it: shares of
/// its full travel, -1 to 1.
struct SixDofState {
    glm::dvec3 push{0.0};  ///< right, up, forward
    glm::dvec3 turn{0.0};  ///< nose up, nose left, right side down: counterclockwise about right and up,
                           ///< clockwise about forward as seen from behind
    uint32_t buttons = 0;  ///< bit i: button i is down

    bool at_rest() const { return push == glm::dvec3(0.0) && turn == glm::dvec3(0.0); }
    bool operator==(const SixDofState&) const = default;
};

/// Applies one HID report of a 3Dconnexion device to `state`. The first byte is the report's number: 1 pushes
/// (followed by turns in newer devices), 2 turns, 3 buttons. Values are 16-bit little-endian, +-350 at full
/// travel, along axes to the right, toward the user and down. Other reports (batteries, displays) and
/// truncated ones change nothing; the function then returns false.
bool take_report(std::span<const std::byte> report, SixDofState& state);

/// Which axis of the device moves what, and by how much. Axes are in the order right, up, forward, nose up,
/// nose left, right side down.
struct SixDofMapping {
    static constexpr size_t kAxes = 6;
    std::array<uint8_t, kAxes> from{0, 1, 2, 3, 4, 5};  ///< the device's axis for each of them
    std::array<double, kAxes> scale{1, 1, 1, 1, 1, 1};  ///< negative reverses the axis, 0 turns it off
    double sensitivity = 1;                             ///< for all axes
    double dead_zone = 0.05;                            ///< share of the travel that counts as rest, 0 to .9

    bool operator==(const SixDofMapping&) const = default;
    /// Returns the state with dead zone, mapping and sensitivity applied. It is still 0 at rest, and does not
    /// jump at the edge of the dead zone. Buttons stay unchanged.
    SixDofState apply(const SixDofState& state) const;
};

}  // namespace lucarne::io
