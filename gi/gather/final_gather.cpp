#include "gi/gather/final_gather.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/bounce_options.h"
#include "gi/gather/gather_options.h"
#include "gi/gather/upsample.h"
#include "gi/gl_frame.h"
#include "gi/lighting/direct_light.h"
#include "gi/shared/brdf.h"
#include "gi/shared/lobe.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kPixelsATask = 4096, kPointsATask = 256;
/// Share of the time that buffers take if bright light comes by rays.
constexpr double kBuffersShare = 0.8;
/// Micro-buffers of specular lobes end where the lobe has fallen to this share of its peak; the rest is a
/// thousandth of its light.
constexpr float kLobeEnd = 1e-3f;

enum class Lobe : uint8_t { diffuse, specular };

/// Returns the scale of micro-buffers of lobes with an exponent (GatherPoint).
float lobe_scale(Warp warp, float exponent) {
    return warp == Warp::hemisphere ? 1.0f : std::sqrt(1 - std::pow(kLobeEnd, 2 / exponent));
}

/// One picture of gathered light: of one lobe of the pixels that have it.
class LobeGather {
 public:
    LobeGather(Frame& frame, ClDevice& device, Gatherer& gatherer, Gathered what, const BufferStyle& style,
               GatherCounts& counts)
        : frame_(frame),
          device_(device),
          gatherer_(gatherer),
          what_(what),
          style_(style),
          counts_(counts),
          seed_(mix64(frame.settings[kSeed], frame.index)) {}

    /// Sets the mean that the lobe of each surface gathers (GatherPoint). A surface without a radius gathers
    /// nothing.
    Result<void> run(Lobe lobe, std::span<const SurfacePoint> surfaces,
                     std::span<const Reflectance> reflectances, const RareLight& rare,
                     std::vector<glm::vec4>& light) {
        lobe_ = lobe;
        surfaces_ = surfaces;
        reflectances_ = reflectances;
        bright_ = nullptr;
        gatherer_.set_no_bright();
        gatherer_.set_no_openings();
        if (rare.find_bright) {
            LUCARNE_ASSIGN(bright_, timed(frame_, "bright light", [&] {
                               return rare.find_bright(pilots(BrightLight::kPilots), seed_);
                           }));
        }
        if (rare.find_openings) {
            LUCARNE_ASSIGN(const SkyOpenings* openings, timed(frame_, "openings to the sky", [&] {
                               return rare.find_openings(pilots(SkyOpenings::kPilots), seed_);
                           }));
            LUCARNE_TRY(gatherer_.set_openings(device_, openings, SkyOpenings::kRays));
        }
        const GatherGrid grid = gather_grid(frame_);
        const std::vector<uint32_t> pixels = grid.pixels();
        std::vector<glm::vec4> gathered;
        LUCARNE_TRY(timed(frame_, "gather", [&] { return gather_at(pixels, gathered, false); }));
        if (grid.step == 1) {
            light = std::move(gathered);
            return {};
        }
        if (frame_.stopped()) return {};
        light.resize(surfaces.size());
        const TimedPass pass(frame_, "upsample");
        const auto missing = upsample(frame_.camera, surfaces, grid, gathered, light);
        counts_.again += missing.size();
        LUCARNE_TRY(gather_at(missing, gathered, true));
        for (size_t i = 0; i < missing.size(); ++i) light[missing[i]] = gathered[i];
        return {};
    }

 private:
    GatherPoint point_of(uint32_t pixel) const {
        const SurfacePoint& at = surfaces_[pixel];
        GatherPoint point{.position = at.position,
                          .lift = at.radius,
                          .normal = at.normal,
                          .seed = static_cast<uint32_t>(mix64(seed_, pixel)),
                          .viewer = at.viewer,
                          .exponent = 0,
                          .axis = at.normal,
                          .scale = 1};
        if (lobe_ == Lobe::specular) {
            point.exponent = reflectances_[pixel].exponent;
            point.axis = glm::normalize(2 * glm::dot(at.normal, at.viewer) * at.normal - at.viewer);
            point.scale = lobe_scale(style_.warp, point.exponent);
        }
        return point;
    }
    /// Returns about so many pixels that gather, all over the picture.
    std::vector<GatherPoint> pilots(uint64_t count) const {
        std::vector<uint32_t> shown;
        for (uint32_t i = 0; i < surfaces_.size(); ++i)
            if (surfaces_[i].radius > 0) shown.push_back(i);
        std::vector<GatherPoint> points;
        if (shown.empty()) return points;
        Random random(seed_, count);
        for (uint64_t i = 0; i < count; ++i) {
            const double share = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
            points.push_back(point_of(shown[static_cast<size_t>(share * static_cast<double>(shown.size()))]));
        }
        return points;
    }
    /// Gathers at those of these pixels that have a surface; results in their order.
    Result<void> gather_at(std::span<const uint32_t> pixels, std::vector<glm::vec4>& results, bool again) {
        std::vector<GatherPoint> points;
        std::vector<size_t> places;
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (!(surfaces_[pixels[i]].radius > 0)) continue;
            points.push_back(point_of(pixels[i]));
            places.push_back(i);
        }
        std::vector<glm::vec4> found(points.size());
        // Pixels that gather again come on top of those that were expected.
        const double buffers = bright_ ? kBuffersShare : 1;
        const auto done = [&](size_t count) {
            if (!again) report(buffers * static_cast<double>(count) / static_cast<double>(points.size()));
        };
        LUCARNE_TRY(gatherer_.gather(device_, what_, points, frame_.settings[kMicroBuffer], seed_, found,
                                     frame_.stop, done, style_.fill));
        if (bright_) add_bright(points, found);
        if (!again && !frame_.stopped()) report(1);
        results.assign(pixels.size(), glm::vec4(0.0f));
        for (size_t i = 0; i < places.size(); ++i) results[places[i]] = found[i];
        counts_.points += points.size();
        return {};
    }

    void add_bright(std::span<const GatherPoint> points, std::span<glm::vec4> light) const {
        parallel_ranges(points.size(), kPointsATask, [&](size_t first, size_t last) {
            for (size_t i = first; i < last && !frame_.stopped(); ++i)
                light[i] += glm::vec4(bright_->at(points[i], points[i].seed), 0);
        });
    }

    /// Reports this share of the lobe's picture as finished: of all pixels, one part for each lobe.
    void report(double share) {
        if (!frame_.progress) return;
        const double lobes = glossy(frame_) ? 2 : 1, before = lobe_ == Lobe::specular ? 1 : 0;
        const auto pixels =
            static_cast<size_t>((before + share) / lobes * static_cast<double>(surfaces_.size()));
        frame_.progress->add(pixels - reported_);
        reported_ = pixels;
    }

    Frame& frame_;
    ClDevice& device_;
    Gatherer& gatherer_;
    Gathered what_;
    BufferStyle style_;
    GatherCounts& counts_;
    uint64_t seed_;
    size_t reported_ = 0;  ///< pixels
    Lobe lobe_ = Lobe::diffuse;
    const BrightLight* bright_ = nullptr;  ///< what the gatherer leaves out
    std::span<const SurfacePoint> surfaces_;
    std::span<const Reflectance> reflectances_;
};

}  // namespace

GatherGrid gather_grid(const Frame& frame) {
    const uint32_t step = frame.settings[kGatherEvery];
    const uint64_t seed = mix64(frame.settings[kSeed], frame.index);
    // The pixels that gather move from frame to frame, so that averages of frames blur nothing.
    const uint32_t place =
        frame.index == 0 ? (step / 2) * (step + 1) : static_cast<uint32_t>(mix64(seed) % (step * step));
    return {frame.camera.width, frame.camera.height, step, place % step, place / step};
}

Result<std::vector<glm::vec4>> gather_pixels(Frame& frame, ClDevice& device, Gatherer& gatherer,
                                             Gathered what, const RareLight& rare, const BufferStyle& style,
                                             GatherCounts& counts) {
    auto surfaces = visible_surfaces(frame.camera, download_gbuffer(frame));
    std::vector<glm::vec4> light;
    LobeGather gather(frame, device, gatherer, what, style, counts);
    LUCARNE_TRY(gather.run(Lobe::diffuse, surfaces, {}, rare, light));
    if (frame.stopped()) return light;
    const std::vector<Reflectance> reflectances = reflect_evenly(frame, surfaces, light);
    LUCARNE_TRY(reflect_by_lobes(frame, device, gatherer, what, std::move(surfaces), reflectances, light,
                                 counts, style));
    return light;
}

std::vector<Reflectance> reflect_evenly(const Frame& frame, std::span<const SurfacePoint> surfaces,
                                        std::span<glm::vec4> light) {
    const std::vector<Material> materials = device_materials(frame.materials);
    std::vector<Reflectance> reflectances(surfaces.size());
    parallel_ranges(surfaces.size(), kPixelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            reflectances[i] =
                make_reflectance(materials[surfaces[i].material % materials.size()], surfaces[i].albedo);
            light[i] = glm::vec4(reflectances[i].kd * glm::vec3(light[i]), 0);
        }
    });
    return reflectances;
}

Result<void> reflect_by_lobes(Frame& frame, ClDevice& device, Gatherer& gatherer, Gathered what,
                              std::vector<SurfacePoint> surfaces, std::span<const Reflectance> reflectances,
                              std::span<glm::vec4> light, GatherCounts& counts, const BufferStyle& style) {
    if (!glossy(frame)) return {};
    for (size_t i = 0; i < surfaces.size(); ++i)
        if (!(reflectances[i].ks > 0)) surfaces[i].radius = 0;
    if (std::ranges::none_of(surfaces, [](const SurfacePoint& at) { return at.radius > 0; })) return {};
    std::vector<glm::vec4> lobe;
    LobeGather gather(frame, device, gatherer, what, style, counts);
    LUCARNE_TRY(gather.run(Lobe::specular, surfaces, reflectances, {}, lobe));
    if (frame.stopped()) return {};
    for (size_t i = 0; i < light.size(); ++i) {
        const Reflectance& r = reflectances[i];
        if (!(surfaces[i].radius > 0)) continue;
        const float scale = lobe_scale(style.warp, r.exponent);
        light[i] += r.ks * (r.exponent + 2) / 2 * scale * scale * glm::vec4(glm::vec3(lobe[i]), 0);
    }
    return {};
}

}  // namespace lucarne::gi
