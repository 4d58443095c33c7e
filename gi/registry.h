#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "gi/engine.h"

namespace lucarne::gi {

struct EngineEntry {
    EngineInfo info;
    std::unique_ptr<Engine> (*make)();
};

/// All engines, in the order they are listed to users.
std::span<const EngineEntry> engines();

/// Errors (ErrorKind::arguments): unknown name; the message lists the known ones.
Result<std::unique_ptr<Engine>> make_engine(std::string_view name);

}  // namespace lucarne::gi
