#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "gi/engine.h"

namespace lucarne::gi {

/// Returns all engines in the order in which users see them. engine_list.cpp holds the list.
std::span<const EngineEntry> engines();
/// Returns the engine that is used if none is chosen.
const EngineInfo& default_engine();
/// Returns the engine that draws in the place of one that takes long or computes in advance.
const EngineInfo& stand_in_engine();

/// Find or make an engine by name. Errors (ErrorKind::arguments): unknown name; the message lists the known
/// names. Making also fails as can_run() does.
Result<const EngineEntry*> find_engine(std::string_view name);
Result<std::unique_ptr<Engine>> make_engine(std::string_view name);
/// Returns whether the engine can run on this machine: whether the devices that it needs are there. Looks
/// once for each kind of device. Errors: why not, and which package brings it.
Result<void> can_run(const EngineInfo& engine);
/// Returns the first engine that has the property; the default engine if none has it.
const EngineInfo& engine_with(bool EngineInfo::*property);
/// Returns whether an engine of this name exists and has the property.
bool engine_is(std::string_view name, bool EngineInfo::*property);
/// Returns what people see in place of an engine's name; the name if no engine has it.
std::string label_of(std::string_view name);

}  // namespace lucarne::gi
