#pragma once

#include <functional>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/gather/bright_light.h"
#include "gi/gather/gatherer.h"
#include "gi/gather/sky_openings.h"
#include "gi/gather/upsample.h"
#include "gi/host_frame.h"
#include "gi/shared/brdf.h"

namespace lucarne::gi {

struct GatherCounts {
    size_t points = 0;  ///< micro-buffers of the frame
    size_t again = 0;   ///< of these, for pixels between which nothing could be interpolated
};

/// Finds the light that is bright for some points and tells the gatherer to leave it out. The second argument
/// is a seed. Returns none if there is none.
using FindBright = std::function<Result<const BrightLight*>(std::span<const GatherPoint>, uint64_t)>;
/// Finds the openings to the sky that some points see. The second argument is a seed.
using FindOpenings = std::function<Result<const SkyOpenings*>(std::span<const GatherPoint>, uint64_t)>;

/// Light that few rays of micro-buffers would find by chance, and that rays of its own bring.
struct RareLight {
    FindBright find_bright;      ///< none: buffers find all light of surfels
    FindOpenings find_openings;  ///< none: buffers find all of the sky
};

/// How micro-buffers are drawn: as by default, or as in the figures of the paper for comparison.
struct BufferStyle {
    Fill fill = Fill::rays;
    Warp warp = Warp::lobe;
};

/// Returns what each pixel of the frame reflects of `what`, the light that `gatherer` holds, W/(sr m^2),
/// row 0 on top. Diffuse and specular lobes gather by micro-buffers of their own. Pixels between those that
/// gather (kGatherEvery) are interpolated. Leaves out the rest if the frame is stopped. Errors: the device
/// failed.
Result<std::vector<glm::vec4>> gather_pixels(Frame& frame, ClDevice& device, Gatherer& gatherer,
                                             Gathered what, const RareLight& rare, const BufferStyle& style,
                                             GatherCounts& counts);

/// Turns the mean radiance that each pixel receives (`light`) into what it reflects evenly, W/(sr m^2).
/// Returns the pixels' reflectances.
std::vector<Reflectance> reflect_evenly(const Frame& frame, std::span<const SurfacePoint> surfaces,
                                        std::span<glm::vec4> light);

/// Adds what pixels reflect by specular lobes, which gather by micro-buffers of their own, as above. A
/// surface without a radius has no lobe. Errors likewise.
Result<void> reflect_by_lobes(Frame& frame, ClDevice& device, Gatherer& gatherer, Gathered what,
                              std::vector<SurfacePoint> surfaces, std::span<const Reflectance> reflectances,
                              std::span<glm::vec4> light, GatherCounts& counts,
                              const BufferStyle& style = {});

/// Returns which pixels of a frame gather light for those between them (kGatherEvery).
GatherGrid gather_grid(const Frame& frame);

}  // namespace lucarne::gi
