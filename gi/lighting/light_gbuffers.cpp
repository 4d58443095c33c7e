#include "gi/lighting/light_gbuffers.h"

#include <algorithm>
#include <utility>

#include "gi/host_frame.h"
#include "gi/steps.h"

namespace lucarne::gi {
namespace {

constexpr size_t kLeastHeld = 6;  // views: the six of a point light
constexpr size_t kHeldShare = 3;  // more views are held if they fit into this share of the device's memory

}  // namespace

void LightGBuffers::begin(const Device& device, const std::vector<LightView>& views, size_t wanted) {
    size_t largest = 1;
    for (const LightView& v : views) largest = std::max(largest, size_t{v.view.width} * v.view.height);
    const size_t fit =
        device.memory_cap() / kHeldShare / (largest * (sizeof(GBufferTexel) + sizeof(uint32_t)));
    most_ = std::clamp<size_t>(wanted, 1, std::max(kLeastHeld, fit));
    for (Held& held : held_)
        held.wanted = std::ranges::any_of(views, [&](const LightView& v) { return v.view == held.view; });
    if (held_.size() <= most_) return;
    std::ranges::sort(held_, std::greater(), [](const Held& h) { return std::pair(h.wanted, h.used); });
    held_.resize(most_);
}

/// Returns where a view is to be drawn: over an older state of the same view, in a new place, or over another
/// view. Of views that are looked at in turn, the one that was looked at last is needed last.
std::vector<LightGBuffers::Held>::iterator LightGBuffers::place_for(const LightView& view) {
    const auto same = std::ranges::find_if(held_, [&](const Held& held) { return held.view == view.view; });
    if (same != held_.end()) return same;
    if (held_.size() < most_) return held_.emplace(held_.end());
    return std::ranges::min_element(held_, {}, [](const Held& held) {
        return held.wanted ? std::pair(true, UINT64_MAX - held.used) : std::pair(false, held.used);
    });
}

template <class Match>
Result<const GBuffer*> LightGBuffers::find_or_draw(Device& device, const LightView& view,
                                                   const Match& match) {
    ++uses_;
    const auto same =
        std::ranges::find_if(held_, [&](const Held& held) { return held.used > 0 && match(held); });
    if (same != held_.end()) {
        same->used = uses_;
        return &same->gbuffer;
    }
    const auto place = place_for(view);
    place->used = 0;
    const auto swap_pictures = [&] {
        std::swap(scratch_.texels, place->gbuffer.texels);
        std::swap(scratch_.ids, place->gbuffer.ids);
    };
    swap_pictures();
    const auto drawn = rasterize(device, *view.cut, view.view, scratch_);
    swap_pictures();
    LUCARNE_TRY(drawn);
    place->view = view.view;
    place->wanted = true;
    place->cut = view.cut->fingerprint();
    place->gbuffer.width = view.view.width;
    place->gbuffer.height = view.view.height;
    place->used = uses_;
    return &place->gbuffer;
}

Result<const GBuffer*> LightGBuffers::look(Device& device, const LightView& view) {
    return find_or_draw(device, view, [&, cut = view.cut->fingerprint()](const Held& held) {
        return held.view == view.view && held.cut == cut;
    });
}

Result<const GBuffer*> LightGBuffers::look_at_any_state(Device& device, const LightView& view) {
    return find_or_draw(device, view, [&](const Held& held) { return held.view == view.view; });
}

Result<bool> LightGBuffers::draw_missing(Device& device, const std::vector<LightView>& views) {
    const auto missing = std::ranges::find_if(views, [&](const LightView& view) {
        return std::ranges::none_of(held_, [&, cut = view.cut->fingerprint()](const Held& held) {
            return held.used > 0 && held.view == view.view && held.cut == cut;
        });
    });
    if (missing == views.end()) return false;
    LUCARNE_TRY(look(device, *missing));
    return true;
}

Result<void> LightGBuffers::renew(Frame& frame, const std::vector<LightView>& views) {
    StepRunner<Frame> runner;
    runner.start({{"light G-buffer", [&](Frame& in) -> Result<StepResult> {
                       const TimedPass timed(in, "light G-buffer");
                       LUCARNE_ASSIGN(const bool drawn, draw_missing(in.gl.device, views));
                       return drawn ? StepResult::again : StepResult::done;
                   }}});
    return runner.run(frame, frame.light_budget, frame.stop);
}

}  // namespace lucarne::gi
