#include "gi/registry.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/device/cl/cl_choice.h"
#include "io/core/options.h"

namespace lucarne::gi {

Result<const EngineEntry*> find_engine(std::string_view name) {
    std::vector<std::string_view> names;
    for (const EngineEntry& entry : engines()) {
        if (entry.info.name == name) return &entry;
        names.push_back(entry.info.name);
    }
    return bad_arguments("", fmt::format("unknown engine '{}'", name), advice(name, names));
}

Result<std::unique_ptr<Engine>> make_engine(std::string_view name) {
    LUCARNE_ASSIGN(const EngineEntry* entry, find_engine(name));
    LUCARNE_TRY(can_run(entry->info));
    return entry->make();
}

Result<void> can_run(const EngineInfo& engine) {
    if (!engine.needs.opencl) return {};
    static const Result<void> opencl = opencl_available();  // looking for devices starts OpenCL's drivers
    return opencl;
}

const EngineInfo& engine_with(bool EngineInfo::*property) {
    for (const EngineEntry& entry : engines())
        if (entry.info.*property) return entry.info;
    return default_engine();
}

bool engine_is(std::string_view name, bool EngineInfo::*property) {
    return std::ranges::any_of(
        engines(), [&](const EngineEntry& entry) { return entry.info.name == name && entry.info.*property; });
}

std::string label_of(std::string_view name) {
    const auto found =
        std::ranges::find(engines(), name, [](const EngineEntry& entry) { return entry.info.name; });
    return std::string(found == engines().end() || found->info.label.empty() ? name : found->info.label);
}

std::span<const OptionInfo* const> engine_options() {
    static const std::vector<const OptionInfo*> all = [] {
        std::vector<const OptionInfo*> options;
        for (const EngineEntry& entry : engines())
            for (const OptionInfo* option : entry.info.options)
                if (std::ranges::find(options, option->key, &OptionInfo::key) == options.end())
                    options.push_back(option);
        return options;
    }();
    return all;
}

}  // namespace lucarne::gi
