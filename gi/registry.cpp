#include "gi/registry.h"

#include <algorithm>
#include <array>
#include <string>

#include "gi/engines/direct/direct.h"
#include "gi/engines/reference/reference.h"
#include "gi/engines/unlit/unlit.h"
#include "gi/engines/vpl/vpl.h"

namespace lucarne::gi {

std::span<const EngineEntry> engines() {
    static const std::array<EngineEntry, 4> all = {{
        {{"direct", "direct light with shadow maps"}, make_direct_engine},
        {{"vpl", "virtual point lights with imperfect shadow maps"}, make_vpl_engine},
        {{"reference", "path tracing over the same surfels: slow, and the truth"}, make_reference_engine},
        {{"unlit", "the points' colours without light: flat, eye-dome lighting or ambient occlusion"},
         make_unlit_engine},
    }};
    return all;
}

Result<std::unique_ptr<Engine>> make_engine(std::string_view name) {
    std::string known;
    for (const EngineEntry& entry : engines()) {
        if (entry.info.name == name) return entry.make();
        known += (known.empty() ? "" : ", ") + std::string(entry.info.name);
    }
    return bad_arguments("engine " + std::string(name), "there is none of this name",
                         "the engines are " + known);
}

}  // namespace lucarne::gi
