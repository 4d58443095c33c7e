#pragma once

#include <functional>
#include <memory>
#include <string>

#include "io/input/six_dof.h"

namespace lucarne::io {

/// The controller's state, as reported to the user.
struct ControllerStatus {
    enum class Kind { none, connected, refused } kind = Kind::none;
    std::string name;     ///< if connected or refused: the device's own name, or its ids
    std::string message;  ///< if refused: the reason, and what to do about it

    bool operator==(const ControllerStatus&) const = default;
};

/// Reads the first available 3Dconnexion controller through libusb on a thread of its own. Devices may be
/// plugged in and unplugged at any time; an unplugged device is at rest.
class Controller {
 public:
    /// Calls `changed` on the controller's thread after every change of state or status. Never fails: without
    /// USB the status says so.
    static std::unique_ptr<Controller> start(std::function<void()> changed);
    ~Controller();
    Controller(const Controller&) = delete;
    Controller& operator=(const Controller&) = delete;

    SixDofState state() const;
    ControllerStatus status() const;
    /// Returns the buttons pressed since the last call; bit i is button i.
    uint32_t take_pressed();

 private:
    Controller();
    struct Reader;
    std::unique_ptr<Reader> reader_;
};

}  // namespace lucarne::io
