#include "gi/gather/lit_tree.h"

namespace lucarne::gi {

Result<void> LitTree::set_surfels(Frame& frame) {
    tree_ = {};
    lobes_ = {};
    LUCARNE_TRY(lit_.set_surfels(frame));
    tree_ = build_tree(lit_.surfels());
    return {};
}

Result<void> LitTree::set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers) {
    lobes_ = {};
    LUCARNE_TRY(lit_.set_light(frame, views, gbuffers, Specular::apart));
    if (lit_.lobes().light.empty()) return {};
    pull_light(tree_, lit_.lobes().light, lobes_.light);
    pull_light(tree_, lit_.lobes().directions, lobes_.directions);
    return {};
}

}  // namespace lucarne::gi
