#include "viewer/cut_choice.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <glm/common.hpp>

#include "viewer/views.h"

namespace lucarne::viewer {
namespace {

constexpr double kFocusCells = 32;  // the light cut's focus moves in steps of 1/32 of the root cube
constexpr int kStepsPerOctave = 64, kMostSteps = 20 * kStepsPerOctave;

constexpr uint64_t kLightShare = 2;  // the light's cuts take up to this part of the room

uint64_t at_step(uint64_t points, int step) {
    return static_cast<uint64_t>(
        std::max(1.0, std::exp2(-static_cast<double>(step) / kStepsPerOctave) * static_cast<double>(points)));
}

octree::Cut view_cut(const CutPurpose& purpose, uint64_t budget) {
    return octree::view_cut(purpose.source, octree_view(purpose.camera, purpose.size), budget,
                            purpose.budgets.pixel_spacing);
}

/// The cuts of the light, of at most `step` below `whole`, or below the budgets where there is none.
void choose_light(const CutPurpose& purpose, const CutSet* whole, int step, CutSet& cuts) {
    cuts.light_views.clear();
    for (size_t i = 0; i < purpose.lights.size(); ++i)
        cuts.light_views.push_back(
            light_view_cut(purpose.source, purpose.lights[i], purpose.light_resolution,
                           whole ? at_step(whole->light_views[i].points, step) : purpose.budgets.light_view));
    // The focus moves in steps, so that bounced light does not shimmer while the camera glides.
    const auto& root = purpose.source.header().root;
    const double cell = root.size / kFocusCells;
    const glm::dvec3 focus = root.min + glm::floor((purpose.camera.position - root.min) / cell + 0.5) * cell;
    cuts.light = octree::light_cut(purpose.source, focus,
                                   whole ? at_step(whole->light.points, step) : purpose.budgets.light);
}

bool fits(const CutPurpose& purpose, const CutSet& cuts, const CutRoom& room) {
    std::unordered_set<uint32_t> counted;
    uint64_t bytes = 0;
    for (const octree::Cut* cut : cuts.all())
        for (const octree::CutNode& node : cut->nodes)
            if (counted.insert(node.node).second) bytes += room.cost(purpose.source.nodes()[node.node]);
    return bytes <= room.bytes;
}

/// The least step from 1 on that fits, kMostSteps if none does. More points never leave out a node, so there
/// is one: it lies between `beyond`, which does not fit, and `within`. Both are looked for from `guess` on,
/// with ever longer strides, and then halved.
int least_step(int guess, const std::function<bool(int)>& fits_at) {
    int beyond = 0, within = kMostSteps;
    const auto narrow = [&](int step) { (fits_at(step) ? within : beyond) = step; };
    for (int step = guess, stride = 1; beyond < step && step < within; stride *= 2) {
        narrow(step);
        step += within == step ? -stride : stride;
    }
    while (within - beyond > 1) narrow((beyond + within) / 2);
    return within;
}

}  // namespace

std::vector<const octree::Cut*> CutSet::all() const {
    std::vector<const octree::Cut*> cuts = {&view, &light};
    for (const octree::Cut& cut : light_views) cuts.push_back(&cut);
    return cuts;
}

uint64_t CutSet::points() const {
    uint64_t sum = 0;
    for (const octree::Cut* cut : all()) sum += cut->points;
    return sum;
}

CutSet CutChooser::choose(const CutPurpose& purpose, const CutRoom& room) {
    CutSet whole;
    choose_light(purpose, nullptr, 0, whole);
    CutSet cuts = whole;
    const CutRoom light_room{room.bytes / kLightShare, room.cost};
    if (!fits(purpose, cuts, light_room)) {
        light_step_ = least_step(light_step_, [&](int step) {
            choose_light(purpose, &whole, step, cuts);
            return fits(purpose, cuts, light_room);
        });
        choose_light(purpose, &whole, light_step_, cuts);
    }
    cuts.view = whole.view = view_cut(purpose, purpose.budgets.view);
    if (!fits(purpose, cuts, room)) {
        view_step_ = least_step(view_step_, [&](int step) {
            cuts.view = view_cut(purpose, at_step(whole.view.points, step));
            return fits(purpose, cuts, room);
        });
        cuts.view = view_cut(purpose, at_step(whole.view.points, view_step_));
    }
    cuts.share =
        static_cast<double>(cuts.points()) / static_cast<double>(std::max<uint64_t>(whole.points(), 1));
    return cuts;
}

}  // namespace lucarne::viewer
