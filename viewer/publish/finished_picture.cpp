#include "viewer/publish/finished_picture.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "viewer/frame/rgba.h"
#include "viewer/overlay/draw_marks.h"
#include "viewer/overlay/figure_scale.h"
#include "viewer/overlay/overlay.h"

namespace lucarne::viewer {
namespace {

constexpr uint32_t kTextHeight = 540;  ///< picture height, pixels, for each step of text size

/// Draws the overlays that the look requests.
void draw_overlay(const Pipeline& pipeline, const gi::SceneCamera& camera, io::Image8& picture) {
    const int scale = std::max(static_cast<int>(picture.height / kTextHeight), 1);
    OverlayView view;
    view.camera = camera;
    view.distance = glm::distance(camera.position, camera.target);
    view.metres_per_unit = pipeline.source().header().metres_per_unit;
    view.size = {picture.width, picture.height};
    view.font = 13.0 * scale;
    draw_marks(overlay(pipeline.scene().look, pipeline.values(), view), scale, picture);
    draw_marks(figure_scale(pipeline.scene(), pipeline.exposure_ev(), view), scale, picture);
}

/// Calls `nothing` with the number of each pixel that shows no point.
template <class Nothing>
void where_nothing_is(const Pipeline& pipeline, const Nothing& nothing) {
    const gi::GBuffer& gbuffer = pipeline.gbuffer();
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    const auto texels = gbuffer.texels.download_all<gi::GBufferTexel>(pixels);
    for (size_t i = 0; i < pixels; ++i)
        if (!(texels[i].depth > 0)) nothing(i);
}

}  // namespace

io::Image8 finished_picture(const Pipeline& pipeline, const gi::SceneCamera& camera,
                            const PictureFinish& finish) {
    const ImageSize size{pipeline.gbuffer().width, pipeline.gbuffer().height};
    const size_t pixels = size_t{size.width} * size.height;
    io::Image8 picture = without_alpha(pipeline.picture().download_all<std::byte>(pixels * 4), size);
    if (finish.transparent) {
        picture.alpha.assign(pixels, 255);
        where_nothing_is(pipeline, [&](size_t i) {
            picture.alpha[i] = 0;
            std::fill_n(picture.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, uint8_t{0});
        });
    }
    if (finish.overlays) draw_overlay(pipeline, camera, picture);
    return picture;
}

void clear_where_nothing_is(const Pipeline& pipeline, io::Image& radiance) {
    for (glm::vec4& pixel : radiance.pixels) pixel.w = 1;
    where_nothing_is(pipeline, [&](size_t i) { radiance.pixels[i] = glm::vec4(0); });
}

}  // namespace lucarne::viewer
