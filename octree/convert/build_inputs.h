#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Decides what to estimate: empty for nothing, true for normals and areas, false for areas only. `complete`:
/// every point has a usable normal of its own (PointNormals), as far as is known yet. Errors: normals are to
/// be kept, and an input has none.
Result<std::optional<bool>> wanted_normals(NormalsMode mode, const Unifier& inputs, bool complete);

/// Returns the metres per unit of all inputs: the unit that most inputs with points state, the first of these
/// in a tie, and metres if none states one.
double common_unit(const Unifier& inputs);
/// Errors: an input with points states another unit than common_unit().
Result<void> check_units(const Unifier& inputs);
/// Does the same for one scan. `who` begins the other half of the message, for example "the cache has".
Result<void> check_unit(const io::ScanInfo& scan, double metres_per_unit, std::string_view who);
/// Warns if a scan does not state its unit and is not taken as metres.
void warn_of_assumed_unit(const io::ScanInfo& scan, double metres_per_unit);

/// Warns about scans in different coordinate systems and about extra bytes with different scales: their
/// points are joined without conversion.
void warn_of_differences(const Unifier& inputs);
void warn_of_differences(std::span<const io::ScanInfo> scans);

/// Adjusts a scan's description to the records of a cache. `own` is the scan's schema, `schema` the cache's.
/// Where 8-bit colours became 16-bit ones because of another scan, they span all 16 bits (RecordMap).
void widen_colour(io::ScanInfo& scan, const io::Schema& own, const io::Schema& schema);
/// Does the same for a scan that was read. Colours larger than those of the sample, from which the scan's
/// colour bits were guessed, correct them.
void adjust_colour(io::ScanInfo& scan, const io::Schema& own, const io::Schema& schema,
                   const io::Contents& contents);

/// Errors: the descriptions of the inputs are more than the metadata of a cache can hold. Tells it before the
/// work, not when the cache is written.
Result<void> check_descriptions(const Unifier& inputs);

/// Returns the header of a cache of these inputs with records of `schema`.
SourceHeader header_of(const Unifier& inputs, const ScanFacts& facts, const io::Schema& schema);

}  // namespace lucarne::octree
