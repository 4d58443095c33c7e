#include "gi/gather/lit_tree.h"

namespace lucarne::gi {

Result<void> LitTree::set_surfels(Frame& frame) {
    tree_ = std::make_shared<SurfelTree>();
    lobes_ = {};
    LUCARNE_TRY(lit_.set_surfels(frame));
    tree_ = std::make_shared<SurfelTree>(build_tree(lit_.surfels()));
    return {};
}

Result<void> LitTree::set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers) {
    lobes_ = {};
    LUCARNE_TRY(lit_.set_light(frame, views, gbuffers, Specular::apart));
    lobes_ = pulled(lit_.lobes());
    return {};
}

SideLobes LitTree::pulled(const SideLobes& by_surfel) const {
    SideLobes slots;
    if (by_surfel.light.empty()) return slots;
    pull_light(*tree_, by_surfel.light, slots.light);
    pull_light(*tree_, by_surfel.directions, slots.directions);
    return slots;
}

}  // namespace lucarne::gi
