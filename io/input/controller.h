#pragma once

#include <functional>
#include <memory>
#include <string>

#include "io/input/six_dof.h"

namespace lucarne::io {

/// What is to be said of the controller.
struct ControllerStatus {
    enum class Kind { none, connected, refused } kind = Kind::none;
    std::string name;     ///< connected or refused: the device's own, else its numbers
    std::string message;  ///< refused: why, and what to do about it

    bool operator==(const ControllerStatus&) const = default;
};

/// The first 3Dconnexion controller there is, read through libusb on a thread of its own. Devices come and go
/// at any time; one that is unplugged is at rest.
class Controller {
 public:
    /// `changed` is called on the controller's thread after every change of state or status. Never fails:
    /// without USB the status says so.
    static std::unique_ptr<Controller> start(std::function<void()> changed);
    ~Controller();
    Controller(const Controller&) = delete;
    Controller& operator=(const Controller&) = delete;

    SixDofState state() const;
    ControllerStatus status() const;
    /// The buttons that went down since the last call; bit i is button i.
    uint32_t take_pressed();

 private:
    Controller();
    struct Reader;
    std::unique_ptr<Reader> reader_;
};

}  // namespace lucarne::io
