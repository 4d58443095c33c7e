#pragma once

#include <cstdint>
#include <vector>

#include "octree/convert/chunks/chunk_store.h"
#include "octree/stations/station_spans.h"

namespace lucarne::octree {

/// A point of a scan.
struct ScanPlace {
    uint32_t scan = 0;
    uint64_t point = 0;
};

/// Returns a pass that appends to each record which estimated station saw the point (kStationBytes, for a
/// ChunkStore with stations). `schema` is that of the records of `pass`. `spans`: parts of the scans; a scan
/// is what the attribute `scan` says, or 0 without it, and its points come in its order, of the first scan
/// from `begin` on.
Pass with_point_stations(Pass pass, const io::Schema& schema, const std::vector<StationSpan>& spans,
                         ScanPlace begin = {});

}  // namespace lucarne::octree
