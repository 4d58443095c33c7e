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

/// At a share of the points of `whole`, which was chosen without a limit of room.
CutSet choose_share(const CutPurpose& purpose, const CutSet* whole, int step) {
    const double share = std::exp2(-static_cast<double>(step) / kStepsPerOctave);
    const auto budget = [&](uint64_t most, const octree::Cut* taken) {
        if (!taken) return most;
        return static_cast<uint64_t>(std::max(1.0, share * static_cast<double>(taken->points)));
    };
    const octree::View eye = octree_view(purpose.camera, purpose.size);
    CutSet cuts;
    cuts.share = share;
    cuts.view =
        octree::view_cut(purpose.source, eye, budget(purpose.budgets.view, whole ? &whole->view : nullptr),
                         purpose.budgets.pixel_spacing);
    for (size_t i = 0; i < purpose.lights.size(); ++i)
        cuts.light_views.push_back(
            light_view_cut(purpose.source, purpose.lights[i], purpose.light_resolution,
                           budget(purpose.budgets.light_view, whole ? &whole->light_views[i] : nullptr)));
    // The focus moves in steps, so that bounced light does not shimmer while the camera glides.
    const auto& root = purpose.source.header().root;
    const double cell = root.size / kFocusCells;
    const glm::dvec3 focus = root.min + glm::floor((eye.position - root.min) / cell + 0.5) * cell;
    cuts.light = octree::light_cut(purpose.source, focus,
                                   budget(purpose.budgets.light, whole ? &whole->light : nullptr));
    return cuts;
}

bool fits(const CutPurpose& purpose, const CutSet& cuts, const CutRoom& room) {
    std::unordered_set<uint32_t> counted;
    uint64_t bytes = 0;
    for (const octree::Cut* cut : cuts.all())
        for (const octree::CutNode& node : cut->nodes)
            if (counted.insert(node.node).second) bytes += room.cost(purpose.source.nodes()[node.node]);
    return bytes <= room.bytes;
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
    CutSet whole = choose_share(purpose, nullptr, 0);
    if (fits(purpose, whole, room)) return whole;
    // More points never leave out a node, so that one step is the first to fit. It is between `beyond`, which
    // does not, and `within`: both are looked for from the last frame's on, and then the middle is tried.
    const auto share = [&](int step) { return choose_share(purpose, &whole, step); };
    int beyond = 0, within = kMostSteps;
    CutSet best = share(kMostSteps);
    for (int stride = 1, step = step_; beyond < step && step < within; stride *= 2) {
        CutSet tried = share(step);
        if (fits(purpose, tried, room)) {
            best = std::move(tried);
            within = step;
            step -= stride;
        } else {
            beyond = step;
            step += stride;
        }
    }
    while (within - beyond > 1) {
        const int step = (beyond + within) / 2;
        CutSet tried = share(step);
        if (fits(purpose, tried, room)) {
            best = std::move(tried);
            within = step;
        } else {
            beyond = step;
        }
    }
    step_ = within;
    return best;
}

}  // namespace lucarne::viewer
