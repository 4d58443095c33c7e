#pragma once

#include <functional>
#include <vector>

#include "gi/engine.h"
#include "gi/scene/scene.h"
#include "io/core/options.h"
#include "octree/stream/cut.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// The cuts of a frame. Those that the engines do not need are empty.
struct CutSet {
    gi::EngineNeeds needs;
    octree::Cut view, light;
    std::vector<octree::Cut> light_views;  ///< one for each light, or none
    double share = 1;  ///< share of the points that the cuts would have without a limit of room

    std::vector<const octree::Cut*> all() const;
    uint64_t points() const;
};

/// Inputs of a cut selection.
struct CutPurpose {
    const octree::NodeSource& source;
    const gi::SceneCamera& camera;
    ImageSize size;
    gi::EngineNeeds needs;  ///< of all engines that draw the frame
    const std::vector<gi::SceneLight>& lights;
    uint32_t light_resolution;
    CutBudgets budgets;
    double extent;  ///< extent of the scan without far outliers (octree/tree/robust_bounds.h); world units
    const gi::Clip* clip = nullptr;  ///< the view cut leaves out fully clipped nodes; null: no clip
};

/// Limit on the memory of the nodes of all cuts together.
struct CutRoom {
    uint64_t bytes;
    std::function<uint64_t(const octree::NodeInfo&)> cost;  ///< bytes of a complete node
};

/// Chooses the cuts of successive frames so that together they fit the room. Then no chosen node has to be
/// refused; refused nodes would be missing in the picture. If the unlimited cuts do not fit, their numbers of
/// points are reduced in steps of 1 %: first the lights' views until they fit half of the room, then the
/// light cut until both fit .7 of it, then the view cut until all fit. So the lights' cuts do not depend on
/// the view and stay the same while the camera moves. The result depends only on the purpose and the room,
/// not on earlier choices.
class CutChooser {
 public:
    CutSet choose(const CutPurpose& purpose, const CutRoom& room);

 private:
    // The last frame's reductions, in steps. The search for the next ones starts there.
    int light_view_step_ = 1, light_step_ = 1, view_step_ = 1;
};

}  // namespace lucarne::viewer
