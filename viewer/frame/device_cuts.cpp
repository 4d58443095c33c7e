#include "viewer/frame/device_cuts.h"

#include <algorithm>

namespace lucarne::viewer {
namespace {

bool contains(const gi::DeviceCut& cut, uint32_t node) {
    return std::ranges::binary_search(cut.nodes(), node, {}, &gi::CutNode::node);
}

Result<void> build_cut(const octree::Cut& cut, const CutInputs& from, const gi::Clip& clip,
                       gi::DeviceCut& target) {
    std::vector<gi::CutEntry> entries;
    entries.reserve(cut.nodes.size());
    for (const auto& node : cut.nodes) entries.push_back({node.node, node.count});
    const auto fillings =
        from.scene.look.open_holes ? from.fillings.first(0) : gi::fillings_of(from.fillings, cut.points);
    return from.pool.make_cut(from.device, from.source, entries, from.origin, target, clip, fillings);
}

}  // namespace

void DeviceCuts::node_gone(uint32_t node) {
    const auto has_it = [&](const gi::DeviceCut& cut) { return contains(cut, node); };
    torn_ |= has_it(light_) || std::ranges::any_of(light_views_, has_it);
    changed();
}

bool DeviceCuts::intact(const CutSet& chosen, const gi::Scene& scene) const {
    return !torn_ && needs_ == chosen.needs && light_views_.size() == chosen.light_views.size() &&
           lights_.size() == scene.lights.size();
}

Result<bool> DeviceCuts::build(const CutSet& chosen, const CutInputs& from, bool hold_light) {
    const bool hold = hold_light && intact(chosen, from.scene);
    if (!stale_ && (!light_stale_ || hold)) return false;
    const gi::Clip& clip = from.scene.look.clip;
    const gi::Clip lights_clip = clip.casts ? gi::Clip{} : clip;
    LUCARNE_TRY(build_cut(chosen.view, from, clip, view_));
    if (!chosen.needs.light_cut)
        light_ = {};
    else if (!hold)
        LUCARNE_TRY(build_cut(chosen.light, from, lights_clip, light_));
    light_views_.resize(chosen.light_views.size());
    for (size_t i = 0; i < light_views_.size(); ++i)
        if (!hold || !(lights_[i] == from.scene.lights[i]))
            LUCARNE_TRY(build_cut(chosen.light_views[i], from, lights_clip, light_views_[i]));
    lights_ = from.scene.lights;
    needs_ = chosen.needs;
    stale_ = torn_ = false;
    light_stale_ = hold;
    return true;
}

gi::FrameCuts DeviceCuts::of_frame() const {
    gi::FrameCuts cuts{&view_, {}, needs_.light_cut ? &light_ : nullptr};
    for (const gi::DeviceCut& cut : light_views_) cuts.light_views.push_back(&cut);
    return cuts;
}

uint64_t DeviceCuts::light_view_points() const {
    uint64_t sum = 0;
    for (const gi::DeviceCut& cut : light_views_) sum += cut.surfels();
    return sum;
}

uint64_t DeviceCuts::ready_points() const {
    const auto points = [](const gi::DeviceCut& cut) { return uint64_t{cut.surfels()} + cut.clipped(); };
    uint64_t sum = points(view_) + points(light_);
    for (const gi::DeviceCut& cut : light_views_) sum += points(cut);
    return sum;
}

}  // namespace lucarne::viewer
