#pragma once

#include <memory>

#include "io/formats/ply/header.h"
#include "io/formats/scan.h"

// 3D Gaussian splats in PLY as coloured surfels. Sources: Kerbl et al., "3D Gaussian Splatting for Real-Time
// Radiance Field Rendering", 2023, and the properties that their program writes; Huang et al., "2D Gaussian
// Splatting", 2024 (two scales: flat splats); PlayCanvas, "Compressing Gaussian Splats", 2023, and the
// engine's documented layout.
namespace lucarne::io::ply {

/// Returns whether the vertices are splats as trainers write them: f_dc_*, opacity, scale_* and rot_*.
bool has_splats(const Header& header);
/// Returns whether the vertices are splats of PlayCanvas' compressed layout: packed_position and so on.
bool has_packed_splats(const Header& header);

/// Removes the names of properties that are not read: the view-dependent part of the colour, and normals,
/// which trainers write as zeros. Properties without a name are left out of the layout.
void leave_out_harmonics(Header& header);

/// Wraps the vertices of such a file. A splat becomes a point with
/// - `color` u8 x3: .5 + .28209 f_dc, the colour that is the same from all sides;
/// - `splat_axis` f32 x3: the direction of its shortest axis, whose sign means nothing; zero for a splat that
/// is
///   about as thick as it is wide;
/// - `splat_radius` f32: the radius of the opaque disc that covers as much as the splat, in the file's unit;
/// - `opacity` f32, 0 to 1.
/// Splats with an opacity below kLeastOpacity are left out and counted.
std::unique_ptr<PointSource> open_splats(std::unique_ptr<PointSource> vertices);
inline constexpr float kLeastOpacity = 0.1f;

/// Opens a file of compressed splats, whose points are the same. Errors: other encodings than little-endian,
/// lists, properties that are missing or of another type, fewer bytes than promised (with `salvage` the
/// splats that are there are read).
Result<std::unique_ptr<PointSource>> open_packed_splats(std::shared_ptr<const ByteSource> file, Header header,
                                                        const ReadOptions& options);

}  // namespace lucarne::io::ply
