#include "viewer/ui/view.h"

#include "gi/registry.h"

namespace lucarne::viewer {

Result<void> View::choose_preset(std::string_view name) {
    LUCARNE_ASSIGN(const Preset chosen, find_preset(name));
    const auto found = find_preset(preset);
    const gi::EngineSettings former = found ? found->engine : gi::EngineSettings{};
    const gi::EngineSettings before = method.settings;
    preset = chosen.name;
    method.settings = chosen.engine;
    method.budgets = chosen.budgets;
    // What the user has set is kept; what the former preset had set follows the new one.
    for (const gi::OptionInfo* option : gi::engine_options())
        if (option->keeps && before.get(*option) != former.get(*option))
            method.settings.set(*option, before.get(*option));
    return {};
}

}  // namespace lucarne::viewer
