#pragma once

#include <utility>
#include <variant>
#include <vector>

namespace lucarne::viewer {

/// Commands of actions and panels that wait until the session carries them out, in their order. Each kind of
/// command is a type, which holds what the command needs.
template <class... Kinds>
class CommandQueue {
 public:
    using Command = std::variant<Kinds...>;

    template <class Kind>
    void push(Kind command) {
        waiting_.emplace_back(std::move(command));
    }
    /// Returns the waiting commands and forgets them.
    std::vector<Command> take() { return std::exchange(waiting_, {}); }
    bool empty() const { return waiting_.empty(); }

 private:
    std::vector<Command> waiting_;
};

/// Joins functions, one for each kind of command, for std::visit.
template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;  // Clang 14 deduces no aggregates

}  // namespace lucarne::viewer
