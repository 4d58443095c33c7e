#include "gi/gather/lit_tree.h"

namespace lucarne::gi {

Result<void> LitTree::set_surfels(Frame& frame) {
    tree_ = std::make_shared<SurfelTree>();
    lobes_ = {};
    LUCARNE_TRY(lit_.set_surfels(frame, Bare::of_planes));
    tree_ = std::make_shared<SurfelTree>(build_tree(lit_.surfels()));
    return {};
}

Result<void> LitTree::set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers) {
    lobes_ = {};
    LUCARNE_TRY(lit_.set_light(frame, views, gbuffers, Specular::apart));
    lit_.free_device();
    lobes_ = pulled(lit_.lobes());
    return {};
}

SideLobes LitTree::pulled(const SideLobes& by_surfel) const {
    if (by_surfel.light.empty()) return {};
    return {.light = pull_light(*tree_, by_surfel.light),
            .directions = pull_light(*tree_, by_surfel.directions)};
}

}  // namespace lucarne::gi
