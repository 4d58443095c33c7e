// The true surface of a virtual scan, as a camera sees it and beside the surfels of the scan, and the
// pictures of its mesh that tests/oracles/truth_oracle.py has rendered.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/scene/scene.h"
#include "gi/scene/views.h"
#include "io/core/parallel.h"
#include "io/image/image.h"
#include "io/synthetic/scene_geometry.h"
#include "tests/bench/scan.h"

namespace lucarne::bench {

/// Why a pixel of a scan differs from the true surface.
enum class Cause { empty, nearer, farther, bent, good };
inline constexpr std::array kCauses = {std::pair{Cause::empty, "no surfel"},
                                       std::pair{Cause::nearer, "nearer than the truth"},
                                       std::pair{Cause::farther, "farther than the truth"},
                                       std::pair{Cause::bent, "bent normal"}, std::pair{Cause::good, "good"}};

/// A visible surfel is another surface if it lies farther than this off the plane of the true one, metres:
/// five times the scanner's noise. Measured along the ray, slanting surfaces would exaggerate the noise.
inline constexpr double kOtherSurface = .01;
/// The same in pixels: a disc that is thinner than a pixel shows wherever in the pixel it lies.
inline constexpr double kOtherSurfacePixels = .5;
inline constexpr double kBentDegrees = 10;

/// Returns the angle between two planes of these unit normals, degrees, whichever way they point.
inline double plane_angle(const glm::dvec3& a, const glm::dvec3& b) {
    return std::acos(std::min(1.0, std::abs(dot(a, b)))) * 180 / M_PI;
}

inline constexpr uint32_t kTrueSide = 192;  ///< pixels, of the true pictures
/// The outermost pixels are left out: in the view of the Cornell box their rays pass 2 mm beside its front
/// rim, where every disc sticks out over nothing.
inline constexpr uint32_t kMargin = 1;

/// Returns a picture without its outermost pixels.
inline std::vector<glm::vec4> inner(const std::vector<glm::vec4>& pixels, uint32_t side) {
    std::vector<glm::vec4> kept;
    for (uint32_t y = kMargin; y + kMargin < side; ++y)
        for (uint32_t x = kMargin; x + kMargin < side; ++x) kept.push_back(pixels[size_t{y} * side + x]);
    return kept;
}

/// Returns a picture of half the width and height.
inline std::vector<glm::vec4> halved(const std::vector<glm::vec4>& pixels, uint32_t side) {
    std::vector<glm::vec4> means;
    for (uint32_t y = 0; y + 1 < side; y += 2)
        for (uint32_t x = 0; x + 1 < side; x += 2) {
            const glm::vec4* at = &pixels[size_t{y} * side + x];
            means.push_back((at[0] + at[1] + at[side] + at[side + 1]) / 4.0f);
        }
    return means;
}

/// The true surface behind each of the inner pixels of a square view.
class TrueView {
 public:
    struct Pixel {
        double depth = 0;  ///< m along the camera's forward axis; 0: nothing is visible
        glm::dvec3 normal{0.0};
    };

    /// Leaves out `margin` pixels on each side.
    TrueView(const io::SceneGeometry& geometry, const gi::SceneCamera& camera, const ImageSize& size,
             uint32_t margin = kMargin)
        : view_(gi::camera_view(camera, size, {})),
          margin_(margin),
          inner_(size.width - 2 * margin),
          pixels_(size_t{inner_} * (size.height - 2 * margin)) {
        parallel_ranges(pixels_.size(), inner_, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                const glm::dvec3 along = ray(i);
                const double length = glm::length(along);
                if (const auto hit = geometry.cast(glm::dvec3(view_.origin), along / length))
                    pixels_[i] = {hit->distance / length, hit->normal};
            }
        });
    }

    const std::vector<Pixel>& pixels() const { return pixels_; }
    /// Returns the direction of a pixel's ray, as in gi/shared/camera.h: one metre of depth long.
    glm::dvec3 ray(size_t pixel) const {
        const double x = 2 * (static_cast<double>(pixel % inner_ + margin_) + .5) / view_.width - 1,
                     y = 2 * (static_cast<double>(pixel / inner_ + margin_) + .5) / view_.height - 1;
        return glm::dvec3(view_.forward) + glm::dvec3(view_.right) * x - glm::dvec3(view_.up) * y;
    }
    /// Compares a pixel with what a scan shows there: normal and depth, as `lucarne render --gbuffer` writes.
    Cause cause(size_t pixel, const glm::vec4& shown) const {
        const Pixel& truth = pixels_[pixel];
        if (!(shown.w > 0)) return truth.depth > 0 ? Cause::empty : Cause::good;
        if (!(truth.depth > 0)) return Cause::nearer;  // a rim that sticks out over nothing
        const double off = (shown.w - truth.depth) * dot(ray(pixel), truth.normal);
        const double pixel_size = 2 * glm::length(glm::dvec3(view_.up)) * truth.depth / view_.height;
        if (std::abs(off) > std::max(kOtherSurface, kOtherSurfacePixels * pixel_size))
            return shown.w < truth.depth ? Cause::nearer : Cause::farther;
        return plane_angle(truth.normal, glm::dvec3(shown)) > kBentDegrees ? Cause::bent : Cause::good;
    }

 private:
    gi::CameraView view_;
    uint32_t margin_, inner_;  ///< pixels left out on each side; width of the inner picture
    std::vector<Pixel> pixels_;
};

/// A view of a scene whose mesh has been rendered.
struct TrueScene {
    std::shared_ptr<const io::SceneGeometry> geometry;
    gi::SceneCamera camera;
    std::string pictures;  ///< the start of their names
    std::string scene, view;

    static Result<TrueScene> open(const std::string& scene, const std::string& view) {
        LUCARNE_ASSIGN(auto geometry, io::SceneGeometry::create(scene));
        LUCARNE_ASSIGN(const gi::Scene lit, gi::load_scene(scene_file(scene)));
        for (const gi::SceneCamera& camera : lit.cameras)
            if (camera.name == view)
                return TrueScene{
                    std::move(geometry), camera,
                    std::string(LUCARNE_SOURCE_DIR) + "/tests/oracles/truth/" + scene + "-" + view + "-",
                    scene, view};
        return failed(scene_file(scene), "has no camera " + view);
    }
    /// Reads the inner pixels of the sum of pictures: "bounce-0" and so on.
    Result<std::vector<glm::vec4>> picture(const std::vector<std::string>& names) const {
        std::vector<glm::vec4> whole(size_t{kTrueSide} * kTrueSide);
        for (const std::string& name : names) {
            LUCARNE_ASSIGN(const io::Image part, io::read_exr(pictures + name + ".exr"));
            if (part.width != kTrueSide || part.height != kTrueSide)
                return failed(pictures + name + ".exr", "has another size");
            for (size_t i = 0; i < whole.size(); ++i) whole[i] += part.pixels[i];
        }
        return inner(whole, kTrueSide);
    }
};

/// How a disc lies on the true surface.
struct DiscFit {
    double distance = 0;  ///< of its centre, m
    double angle = 0;     ///< of its normal, degrees
    double outside = 0;   ///< share of its area that is farther than kOtherSurface off the surface; what lies
                          ///< beyond its line is not part of the disc
    bool at_crease = false;
};

/// Compares discs with the nearest parts of a surface.
class NearestSurface {
 public:
    explicit NearestSurface(const io::SceneGeometry& geometry) : geometry_(geometry) {}

    double distance(const glm::dvec3& position) const { return geometry_.closest(position)->distance; }

    /// `edge`: the line at which the disc ends (gi/shared/edge.h), 1/m; zero: none.
    DiscFit fit(const glm::dvec3& centre, const glm::dvec3& normal, double radius,
                const glm::dvec3& edge) const {
        const auto nearest = geometry_.closest(centre);
        DiscFit fit{nearest->distance, plane_angle(nearest->normal, normal), 0, false};
        const Axes own(normal), true_axes(nearest->normal);
        for (int i = 0; i < kSamples; ++i) {
            const double reach = radius * std::sqrt((i + .5) / kSamples);
            const glm::dvec3 offset = own.at(i, reach);
            if (dot(edge, offset) > 1) continue;
            if (distance(centre + offset) > kOtherSurface) fit.outside += 1.0 / kSamples;
        }
        for (int i = 0; i < kSamples; ++i)
            for (const double side :
                 {-.5, .5}) {  // the other side of an edge is above or below the tangent plane
                const auto probe = [&](double reach) {
                    return geometry_
                        .closest(nearest->position + true_axes.at(i, reach) +
                                 nearest->normal * (side * reach))
                        ->normal;
                };
                if (plane_angle(nearest->normal, probe(kCreaseReach)) > kCreaseDegrees) fit.at_crease = true;
                // Within the scanner's noise of an edge either side is right.
                fit.angle = std::min(fit.angle, plane_angle(normal, probe(kNoise)));
            }
        return fit;
    }

 private:
    static constexpr int kSamples = 8;
    static constexpr double kCreaseReach = .03, kCreaseDegrees = 25;
    static constexpr double kNoise = .006;  ///< m; three standard deviations

    struct Axes {
        glm::dvec3 u, v;
        explicit Axes(const glm::dvec3& normal) {
            const glm::dvec3 other = std::abs(normal.z) < .9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
            u = glm::normalize(cross(normal, other));
            v = cross(normal, u);
        }
        /// Returns the place of a spiral's sample; the golden angle spreads samples evenly (Vogel 1979).
        glm::dvec3 at(int sample, double reach) const {
            const double turn = sample * M_PI * (3 - std::sqrt(5.0));
            return (u * std::cos(turn) + v * std::sin(turn)) * reach;
        }
    };
    const io::SceneGeometry& geometry_;
};

}  // namespace lucarne::bench
