#pragma once

#include <functional>
#include <vector>

#include "gi/engine.h"
#include "gi/scene/scene.h"
#include "io/core/options.h"
#include "octree/stream/cut.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// The cuts of a frame.
struct CutSet {
    octree::Cut view, light;
    std::vector<octree::Cut> light_views;  ///< one a light
    double share = 1;                      ///< of the points that they would take with room for all

    std::vector<const octree::Cut*> all() const;
    uint64_t points() const;
};

/// What they are chosen for.
struct CutPurpose {
    const octree::NodeSource& source;
    const gi::SceneCamera& camera;
    ImageSize size;
    const std::vector<gi::SceneLight>& lights;
    uint32_t light_resolution;
    CutBudgets budgets;
    double extent;  ///< of what is looked at, without far strays (octree/tree/bulk.h); world units
    const gi::Clip* clip = nullptr;  ///< cubes that it leaves nothing of are not for the eye; none: all are
};

/// What may be held of the nodes of all cuts together.
struct CutRoom {
    uint64_t bytes;
    std::function<uint64_t(const octree::NodeInfo&)> cost;  ///< of a node, whole
};

/// Chooses the cuts of one frame after another, so that together they fit the room: nothing that is chosen
/// has to be refused, which would take whole nodes from the picture at once. Where they do not fit, the
/// lights' views get the share of the points that they would take without a limit that fits half of the room,
/// then the light cut what fits .7 of it beside them, then the view cut what is left, in steps of 1 %. So
/// light does not follow the view: while the camera glides, its cuts hold. The same cuts for the same purpose
/// and room, whatever was chosen before.
class CutChooser {
 public:
    CutSet choose(const CutPurpose& purpose, const CutRoom& room);

 private:
    // The last frame's steps below what was wanted; the next are looked for around them.
    int light_view_step_ = 1, light_step_ = 1, view_step_ = 1;
};

}  // namespace lucarne::viewer
