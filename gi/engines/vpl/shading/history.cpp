#include "gi/engines/vpl/shading/history.h"

#include <utility>

#include "gi/engines/vpl/bindings.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi::vpl {
namespace {

// Number of frames in the average. Frames differ in the interleaved tile and the position from which a point
// is lit and, if cuts changed, in the VPLs. Old light must disappear within a blink.
constexpr float kMostFrames = 8;

}  // namespace

History::Basis History::basis_of(const Frame& frame) {
    return {frame.settings, frame.lights, frame.materials, frame.bounds, frame.environment.get()};
}

Result<void> History::begin(const Frame& frame) {
    const size_t pixels = size_t{frame.camera.width} * frame.camera.height;
    if (!(basis_of(frame) == basis_)) camera_ = {};
    LUCARNE_TRY(frame.device.reserve(next_.light, pixels * sizeof(glm::vec4), "the last frame's light"));
    LUCARNE_TRY(
        frame.device.reserve(next_.surfaces, pixels * 2 * sizeof(uint32_t), "the last frame's light"));
    return {};
}

void History::bind(const Frame& frame, const Program& merge) const {
    const Side& last = camera_.width ? last_ : next_;  // not read if there is no last frame
    last.light.bind_texels(kUnitHistory, TexelView::four_floats);
    last.surfaces.bind_texels(kUnitHistorySurfaces, TexelView::two_words);
    next_.light.bind(kBindHistory);
    next_.surfaces.bind(kBindHistorySurfaces);
    set(merge, "last_camera", camera_.width ? camera_ : frame.camera);
    merge.set("most_frames", camera_.width ? kMostFrames : 0.0f);
}

void History::end(const Frame& frame) {
    std::swap(last_, next_);
    camera_ = frame.camera;
    basis_ = basis_of(frame);
}

}  // namespace lucarne::gi::vpl
