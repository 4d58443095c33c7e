#include "viewer/window/actions/actions.h"

#include <array>
#include <functional>

namespace lucarne::viewer {

std::vector<BoundAction> bound_actions(ViewModel& model) {
    std::vector<BoundAction> all;
    bind(file_actions(), std::ref(model), all);
    bind(edit_actions(), std::ref(model), all);
    bind(view_actions(), std::ref(model), all);
    bind(station_actions(), model.stationing(), all);
    bind(bookmark_actions(), model.bookmarking(), all);
    bind(look_actions(), model.styling(), all);
    bind(light_actions(), model.lighting(), all);
    bind(rendering_actions(), model.rendering(), all);
    bind(measure_actions(), model.measuring(), all);
    bind(publish_actions(), model.publishing(), all);
    bind(window_actions(), std::ref(model), all);
    return all;
}

void run_actions(std::span<const BoundAction> actions, std::span<const KeyChord> chords) {
    for (const KeyChord& chord : chords)
        for (const BoundAction& action : actions)
            if ((action.chord == chord || action.other == chord) && action.enabled()) action.run();
}

std::span<const Gesture> gestures() {
    static constexpr std::array kGestures = {
        Gesture{"left drag",
                "turn around the point under the cursor (orbit), around the pivot (turntable); look around "
                "(in a room, fly, walk)"},
        Gesture{"right or middle drag", "shift the view"},
        Gesture{"scroll", "go to the point under the cursor (orbit, turntable); speed (fly, walk)"},
        Gesture{"double-click", "choose the point to turn around; in a room, go there"},
        Gesture{"W A S D, E Q", "fly or walk; with Shift faster"},
        Gesture{"click", "measure the point there, with a tool; select what a label belongs to"},
        Gesture{"left drag on a clip's handle", "move the box's face, or the plane; the ring turns the box"},
        Gesture{"left drag on a light's handle", "move it, or what it shines at; a sun about the scene"},
        Gesture{"left drag on an end of the legend's bar",
                "other values for its colours; double-click: where most values lie"},
        Gesture{"left drag on a comparison's border", "show more of one engine"},
        Gesture{"Shift + left drag", "aim the light at the point under the cursor"},
        Gesture{"Shift + right drag", "move the light sideways"},
    };
    return kGestures;
}

}  // namespace lucarne::viewer
