#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Which normals to estimate: empty for no estimation at all, else whether normals are wanted besides areas.
Result<std::optional<bool>> wanted_normals(NormalsMode mode, const Unifier& inputs);

/// Metres per unit of all inputs: the unit that most of those with points state, the first of these where as
/// many state another; metres where none does.
double common_unit(const Unifier& inputs);
/// Errors: an input with points states another.
Result<void> check_units(const Unifier& inputs);
/// The same of one scan. `who`: "the cache has".
Result<void> check_unit(const io::ScanInfo& scan, double metres_per_unit, std::string_view who);
/// Where a scan does not state its unit and will not be taken as metres.
void warn_of_assumed_unit(const io::ScanInfo& scan, double metres_per_unit);

/// Says which scans are in different coordinate systems, and whose extra bytes are scaled otherwise: their
/// points are put together as they are.
void warn_of_differences(const Unifier& inputs);
void warn_of_differences(std::span<const io::ScanInfo> scans);

/// What a cache with records of `schema` says of a scan with records of `own`: where colours of 8 bits became
/// 16, as of another scan, they are spread over these (RecordMap).
void widen_colour(io::ScanInfo& scan, const io::Schema& own, const io::Schema& schema);

/// Of a cache of these inputs with records of `schema`.
SourceHeader header_of(const Unifier& inputs, const ScanFacts& facts, const io::Schema& schema);

}  // namespace lucarne::octree
