#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "gi/engine.h"

namespace lucarne::gi {

/// All engines, in the order they are listed to users; engine_list.cpp has the list.
std::span<const EngineEntry> engines();
/// What is drawn with where nobody chose.
const EngineInfo& default_engine();

/// Errors (ErrorKind::arguments): unknown name; the message lists the known ones.
Result<const EngineEntry*> find_engine(std::string_view name);
Result<std::unique_ptr<Engine>> make_engine(std::string_view name);
/// The first engine that has the property; the default engine where none has.
const EngineInfo& engine_with(bool EngineInfo::*property);
/// Whether there is such an engine, and it has the property.
bool engine_is(std::string_view name, bool EngineInfo::*property);

}  // namespace lucarne::gi
