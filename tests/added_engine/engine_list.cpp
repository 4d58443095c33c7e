// Replaces gi/engine_list.cpp; it has one more line.
#include <array>

#include "gi/engines/direct/direct.h"
#include "gi/engines/environment/environment.h"
#include "gi/engines/micro/micro.h"
#include "gi/engines/paths/paths.h"
#include "gi/engines/reference/reference.h"
#include "gi/engines/unlit/unlit.h"
#include "gi/engines/volume/volume.h"
#include "gi/engines/vpl/vpl.h"
#include "gi/registry.h"
#include "tests/added_engine/paint/paint.h"

namespace lucarne::gi {

std::span<const EngineEntry> engines() {
    static const std::array all = {direct_engine(),    vpl_engine(),         volume_engine(),
                                   micro_engine(),     environment_engine(), paths_engine(),
                                   reference_engine(), unlit_engine(),       paint_engine()};
    return all;
}

const EngineInfo& default_engine() {
    return vpl_engine().info;
}

const EngineInfo& stand_in_engine() {
    return volume_engine().info;
}

}  // namespace lucarne::gi
