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

}  // namespace

io::Image8 finished_picture(const Pipeline& pipeline, const gi::SceneCamera& camera,
                            const PictureFinish& finish) {
    const ImageSize size{pipeline.gbuffer().width, pipeline.gbuffer().height};
    const size_t pixels = size_t{size.width} * size.height;
    io::Image8 picture = without_alpha(pipeline.picture().download_all<std::byte>(pixels * 4), size);
    if (finish.transparent) {
        const auto radiance = pipeline.points_radiance();
        picture.alpha.resize(pixels);
        for (size_t i = 0; i < pixels; ++i) {
            picture.alpha[i] = static_cast<uint8_t>(radiance[i].w * 255 + 0.5f);
            if (picture.alpha[i] > 0) continue;
            std::fill_n(picture.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, uint8_t{0});
        }
    }
    if (finish.overlays) draw_overlay(pipeline, camera, picture);
    return picture;
}

std::vector<glm::vec4> transparent_radiance(const Pipeline& pipeline) {
    auto radiance = pipeline.points_radiance();
    for (glm::vec4& pixel : radiance) pixel = glm::vec4(glm::vec3(pixel) * pixel.w, pixel.w);
    return radiance;
}

}  // namespace lucarne::viewer
