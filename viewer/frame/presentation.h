#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "gi/device/gl/device.h"
#include "gi/engine.h"
#include "gi/post/exposure.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// Turns the radiance of frames into a picture: average over frames, exposure, tone curve, comparison with a
/// second engine, backdrop. Use from one thread.
class Presentation {
 public:
    explicit Presentation(gi::Device& device) : device_(device) {}

    /// Starts the average again with the next frame.
    void restart() { accumulated_ = 0; }
    /// Frames in the average so far; the next frame continues it.
    uint32_t accumulated() const { return accumulated_; }
    /// Whether the last picture was an average.
    bool averaged() const { return averaged_; }

    /// Whether pixels at edges of the last frame show parts of their neighbours.
    bool soft_edges() const { return edges_; }
    /// Whether w of radiance() and points_radiance() is the share of each pixel that shows points.
    bool knows_shares() const { return mean_shown_; }

    /// The buffer to which the picture's engine (or the compared one) writes its radiance.
    gi::Buffer& sample(bool compared) { return compared ? other_.sample : own_.sample; }

    struct Averaging {
        bool on = false;            ///< show the mean of this frame and the frames since restart()
        bool points_apart = false;  ///< average the points' light apart from the background
        bool edges =
            false;  ///< pixels at edges show parts of their neighbours (gi::find_coverage) in the first frame
        uint32_t gaps = 0;  ///< if over 0: gaps up to twice as many pixels wide are filled
    };
    /// Takes the memory of a picture before engines take theirs, which can do with fewer points.
    /// `compared`: also that of the second engine's. Errors: no device memory.
    Result<void> reserve(size_t pixels, const gi::Scene& scene, const Averaging& averaging, bool compared);
    /// Time in which automatic exposure follows the pictures by 63 %; 0: at once.
    void follow_exposure(double seconds) { exposure_seconds_ = seconds; }
    /// Finishes one frame, whose radiance is in sample(). `other`: the engine to compare with, or null.
    /// Errors: no device memory.
    Result<void> finish(const gi::Engine& engine, const gi::Engine* other, const gi::Scene& scene,
                        const gi::GBuffer& gbuffer, const Averaging& averaging);

    /// Frees the memory of the second engine's pictures.
    void forget_comparison() { other_ = {}; }

    /// The last picture's radiance, vec4 a pixel, row 0 on top. In an average w is the share of the frames
    /// that show a point in the pixel.
    const gi::Buffer& radiance() const { return mean_shown_ ? own_.mean : own_.sample; }
    /// The same without the background, if the points' light was averaged apart; otherwise radiance().
    const gi::Buffer& points_radiance() const { return own_.points_radiance(mean_shown_, points_apart_); }
    /// The last picture, RGBA8 a pixel.
    const gi::Buffer& picture() const { return own_.picture; }
    /// The exposure of the last picture in stops.
    double exposure_ev() const { return exposure_.ev; }

 private:
    struct Images {
        gi::Buffer sample, mean, picture;  ///< radiance of this frame and of the average; RGBA8 picture
        gi::Buffer points;                 ///< average of the points' light alone
        const gi::Buffer& radiance(bool averaged) const { return averaged ? mean : sample; }
        const gi::Buffer& points_radiance(bool averaged, bool apart) const {
            return averaged && apart ? points : radiance(averaged);
        }
    };

    static bool keeps_apart(const gi::Scene& scene, const Averaging& averaging);
    Result<void> add_to_average(Images& images, const gi::GBuffer& gbuffer);
    Result<void> expose(const gi::Engine& lit_by, const Images& images, const gi::Scene& scene,
                        const gi::GBuffer& gbuffer);
    Result<void> show(const gi::Engine& lit_by, const gi::Scene& scene, const gi::GBuffer& gbuffer,
                      Images& images);
    Result<void> compare(const gi::Engine& other, const gi::Scene& scene, const gi::GBuffer& gbuffer);

    gi::Device& device_;
    gi::Buffer materials_;
    Images own_, other_;  ///< of the picture's engine and of the compared engine
    uint32_t accumulated_ = 0;
    bool averaged_ = false, points_apart_ = false;
    bool edges_ = false;       ///< of the last frame
    bool mean_shown_ = false;  ///< the last picture's radiance is in Images::mean
    gi::Exposure exposure_;
    double exposure_seconds_ = 0;
    std::optional<std::chrono::steady_clock::time_point> exposed_;  ///< when exposure was last automatic
};

}  // namespace lucarne::viewer
