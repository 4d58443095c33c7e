#include "viewer/ui/view.h"

#include "gi/registry.h"

namespace lucarne::viewer {

Result<void> View::choose_preset(std::string_view name) {
    LUCARNE_ASSIGN(const Preset chosen, find_preset(name));
    const gi::EngineSettings before = method.settings;
    preset = chosen.name;
    method.settings = chosen.engine;
    method.budgets = chosen.budgets;
    for (const gi::OptionInfo* option : gi::engine_options())
        if (option->keeps) method.settings.set(*option, before.get(*option));
    return {};
}

}  // namespace lucarne::viewer
