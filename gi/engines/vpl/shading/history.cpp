#include "gi/engines/vpl/shading/history.h"

#include <utility>

#include "gi/engines/vpl/bindings.h"
#include "gi/gl_frame.h"
#include "gi/raster/uniforms.h"

namespace lucarne::gi::vpl {
namespace {

// Number of frames in the average. Frames differ in the interleaved tile and the position from which a point
// is lit and, if cuts changed, in the VPLs. Old light must disappear within a blink.
constexpr float kMostFrames = 8;

}  // namespace

Result<void> History::begin(const Frame& frame, const SceneRevisions& scene) {
    const size_t pixels = size_t{frame.camera.width} * frame.camera.height;
    scene_ = scene;
    if (!(scene_ == last_scene_)) camera_ = {};
    LUCARNE_TRY(frame.gl.device.reserve(next_.light, pixels * sizeof(glm::vec4), "the last frame's light"));
    LUCARNE_TRY(
        frame.gl.device.reserve(next_.surfaces, pixels * 2 * sizeof(uint32_t), "the last frame's light"));
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

Result<MappedHistory> History::map() const {
    LUCARNE_ASSIGN(MappedBuffer light, next_.light.map());
    LUCARNE_ASSIGN(MappedBuffer surfaces, next_.surfaces.map());
    MappedHistory mapped{std::move(light), std::move(surfaces), {}, {}, {}};
    mapped.view.next_light = mapped.next_light.as<glm::vec4>().data();
    mapped.view.next_surfaces = mapped.next_surfaces.as<uint32_t>().data();
    if (!camera_.width) return mapped;
    LUCARNE_ASSIGN(MappedBuffer last_light, last_.light.map());
    LUCARNE_ASSIGN(MappedBuffer last_surfaces, last_.surfaces.map());
    mapped.view.last_camera = &camera_;
    mapped.view.most_frames = kMostFrames;
    mapped.view.last_light = last_light.as<const glm::vec4>().data();
    mapped.view.last_surfaces = last_surfaces.as<const uint32_t>().data();
    mapped.last_light.emplace(std::move(last_light));
    mapped.last_surfaces.emplace(std::move(last_surfaces));
    return mapped;
}

void History::end(const Frame& frame) {
    std::swap(last_, next_);
    camera_ = frame.camera;
    last_scene_ = scene_;
}

}  // namespace lucarne::gi::vpl
