#include "gi/changes.h"

#include "gi/gl_frame.h"

namespace lucarne::gi {
namespace {

/// The changes from `before` to the nodes of `cut`, which `before` becomes.
NodeChanges advance(std::vector<CutNode>& before, const DeviceCut* cut) {
    const std::span<const CutNode> now = cut ? cut->nodes() : std::span<const CutNode>();
    NodeChanges changes = node_changes(before, now);
    if (!changes.empty()) before.assign(now.begin(), now.end());
    return changes;
}

}  // namespace

template <class Input>
uint64_t ChangeTracker::Tracked<Input>::update(const Input& now) {
    if (revision == 0 || !(now == input)) {
        input = now;
        ++revision;
    }
    return revision;
}

Changes ChangeTracker::next(const Frame& frame) {
    Changes changes;
    changes.scene = {.settings = settings_.update(frame.settings),
                     .lights = lights_.update(frame.lights),
                     .materials = materials_.update(frame.materials),
                     .environment = environment_.update(frame.environment),
                     .bounds = bounds_.update(frame.bounds)};
    changes.look = look_.update({frame.background, frame.unlit});
    const FrameCuts& cuts = frame.gl.cuts;
    // A fingerprint is equal for equal content, so it serves as the revision.
    changes.view_cut = cuts.view ? cuts.view->fingerprint() : 0;
    changes.light_cuts.light = cuts.light ? cuts.light->fingerprint() : 0;
    for (const DeviceCut* cut : cuts.light_views)
        changes.light_cuts.light_views.push_back(cut->fingerprint());
    changes.view_nodes = advance(view_nodes_, cuts.view);
    changes.light_nodes = advance(light_nodes_, cuts.light);
    return changes;
}

}  // namespace lucarne::gi
