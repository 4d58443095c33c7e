#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "io/points.h"

namespace lucarne::io {

/// Which axis of a file points up. Lucarne's own is z.
enum class UpAxis : uint8_t { x, y, z, minus_x, minus_y, minus_z };
std::optional<UpAxis> up_axis(std::string_view name);  ///< "x", "-y", ...
std::string_view up_axis_name(UpAxis up);

/// Returns the scan turned so that `up` becomes z: positions, normals, axes of splats, stations and the
/// stated box. Turns are by right angles, so coordinates stay exact. The scan itself is returned for z.
std::unique_ptr<PointSource> turned(std::unique_ptr<PointSource> scan, UpAxis up);

}  // namespace lucarne::io
