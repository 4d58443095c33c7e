#include "viewer/frame/cut_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <unordered_set>

#include <glm/common.hpp>

#include "gi/scene/views.h"

namespace lucarne::viewer {
namespace {

constexpr double kFocusCells = 48;  // the light cut's focus moves in steps of 1/48 of the extent
constexpr int kStepsPerOctave = 64, kMostSteps = 20 * kStepsPerOctave;

// Shares of the room for a cut together with the cuts chosen before it. The lights' views come first: if they
// are coarse, large discs of surfaces near a lamp block too much light, which all bounces then lack.
constexpr double kLightViewRoom = 0.5, kLightRoom = 0.7;

uint64_t at_step(uint64_t points, int step) {
    return static_cast<uint64_t>(
        std::max(1.0, std::exp2(-static_cast<double>(step) / kStepsPerOctave) * static_cast<double>(points)));
}

bool fits(const CutPurpose& purpose, const CutSet& cuts, const CutRoom& room) {
    std::unordered_set<uint32_t> counted;
    uint64_t bytes = 0;
    for (const octree::Cut* cut : cuts.all())
        for (const octree::CutNode& node : cut->nodes)
            if (counted.insert(node.node).second) bytes += room.cost(purpose.source.nodes()[node.node]);
    return bytes <= room.bytes;
}

/// Returns the least step (at least 1) that fits, or kMostSteps if none does. The search is valid because a
/// cut with more points contains all nodes of a smaller one. It brackets the step between `beyond`, which
/// does not fit, and `within`, with growing strides from `guess`, and then bisects.
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
    using Points = std::optional<uint64_t>;
    const CutBudgets& budgets = purpose.budgets;
    const auto light_view = [&](size_t i, Points points) {
        return gi::light_view_cut(purpose.source, purpose.lights[i], purpose.light_resolution,
                                  points.value_or(budgets.light_view));
    };
    // The focus moves in steps, so that bounced light does not shimmer while the camera moves.
    const auto& root = purpose.source.header().root;
    const double cell = std::max(purpose.extent, root.size * 1e-6) / kFocusCells;
    const glm::dvec3 focus = root.min + glm::floor((purpose.camera.position - root.min) / cell + 0.5) * cell;
    std::vector<glm::dvec3> lamps;
    for (const gi::SceneLight& lamp : purpose.lights)
        if (lamp.kind != gi::LightKind::directional) lamps.push_back(lamp.position);
    const auto light = [&](size_t, Points points) {
        return octree::light_cut(purpose.source, focus, points.value_or(budgets.light), lamps,
                                 purpose.extent);
    };
    octree::View eye = gi::octree_view(purpose.camera, purpose.size);
    if (purpose.clip && purpose.clip->active())
        eye.wanted = [&](const octree::Cube& cube) { return kept(*purpose.clip, cube) != gi::Kept::none; };
    const auto view = [&](size_t, Points points) {
        return octree::view_cut(purpose.source, eye, points.value_or(budgets.view), budgets.pixel_spacing);
    };
    CutSet whole;
    whole.needs = purpose.needs;
    if (purpose.needs.light_views)
        for (size_t i = 0; i < purpose.lights.size(); ++i) whole.light_views.push_back(light_view(i, {}));
    if (purpose.needs.light_cut) whole.light = light(0, {});
    whole.view = view(0, {});
    whole.share = 1;
    if (fits(purpose, whole, room)) return whole;

    // Makes some of the cuts at full size, then with fewer and fewer points until they fit.
    CutSet cuts;
    cuts.needs = purpose.needs;
    const auto choose = [&](double part, int& step, std::span<octree::Cut> chosen,
                            std::span<const octree::Cut> wanted, const auto& make) {
        const CutRoom part_of_room{static_cast<uint64_t>(part * static_cast<double>(room.bytes)), room.cost};
        std::copy(wanted.begin(), wanted.end(), chosen.begin());
        if (fits(purpose, cuts, part_of_room)) return;
        const auto make_at = [&](int tried) {
            for (size_t i = 0; i < chosen.size(); ++i) chosen[i] = make(i, at_step(wanted[i].points, tried));
            return fits(purpose, cuts, part_of_room);
        };
        step = least_step(step, make_at);
        make_at(step);
    };
    cuts.light_views.resize(whole.light_views.size());
    choose(kLightViewRoom, light_view_step_, cuts.light_views, whole.light_views, light_view);
    if (purpose.needs.light_cut)
        choose(kLightRoom, light_step_, std::span(&cuts.light, 1), std::span(&whole.light, 1), light);
    choose(1, view_step_, std::span(&cuts.view, 1), std::span(&whole.view, 1), view);
    cuts.share =
        static_cast<double>(cuts.points()) / static_cast<double>(std::max<uint64_t>(whole.points(), 1));
    return cuts;
}

}  // namespace lucarne::viewer
