#include "viewer/commands/commands.h"

#include <vector>

namespace lucarne::viewer {

std::span<const AddCommand> commands() {
    static const std::vector<AddCommand> all = {};
    return all;
}

}  // namespace lucarne::viewer
