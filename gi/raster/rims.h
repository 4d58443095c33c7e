#pragma once

#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Lights the rims of surfaces on the same side as the rest of them. Where a surface turns away from the
/// viewer, discs beyond its outline stick out and show their other side; lit on that side, inside a solid
/// body, they would be black. Such a texel is seen at a low angle, and most texels of its surface around it
/// (is_one_surface) show the other side: its normal is turned to the side away from the viewer, only as far
/// as to stand nearly at right angles to the ray. It does not matter on which side the scan's normals stand.
/// Where two faces of a solid meet, discs of the hidden face may stand out beyond the edge of the face in
/// front (is_over_crease), by the noise of the points, and would be lit as a face inside the solid. A texel
/// of a strip of them, narrower than kRimReach pixels, shows what is beyond the strip instead, in that
/// surface's plane and with its id; between two faces it is moved to the plane of the face in front, and its
/// colour and id stay. Call it after rasterize() or blend(). Errors: out of device memory; the shader's.
Result<void> turn_rims(Device& device, const CameraView& view, GBuffer& target);

}  // namespace lucarne::gi
