#pragma once

#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Writes a picture to `mean` in which pixels at edges show parts of their neighbours' light, as
/// find_coverage() has found them: what accumulate() writes for its first sample, with soft edges. Both
/// buffers hold a vec4 a pixel; w of the mean becomes the share of the pixel that shows points. `points_only`
/// leaves out the light of pixels that show no point, so that no background is mixed in. Errors: the
/// shader's.
Result<void> share_edges(Device& device, const Buffer& sample, const GBuffer& gbuffer, bool points_only,
                         Buffer& mean);

/// Returns a further picture of the same pixels (Engine::layers) with soft edges.
std::vector<glm::vec4> share_edges(std::span<const glm::vec4> values, const GBuffer& gbuffer);

}  // namespace lucarne::gi
