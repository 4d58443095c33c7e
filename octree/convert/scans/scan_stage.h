#pragma once

#include <algorithm>
#include <optional>

#include "io/formats/scan.h"
#include "octree/convert/chunks/chunk_store.h"
#include "octree/convert/scans/unify.h"
#include "octree/stations/scan_runs.h"
#include "octree/stations/station_spans.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// The results of one pass over the inputs.
struct ScanFacts {
    uint64_t points = 0, dropped = 0;
    /// Points without a usable normal of their own: the input has none, or the point's is zero or not finite.
    uint64_t without_normal = 0;
    glm::dvec3 min{0.0}, max{0.0};
    Cube root;  ///< the smallest cube at `min` that contains every point
    std::vector<io::Contents> inputs;
    /// Stations of inputs that state none; `scan` is the input's index. At most kMostEstimatedStations.
    std::vector<EstimatedStation> stations;
    /// Which parts of the inputs they saw; sorted. Inputs of which one station saw all have none here.
    std::vector<StationSpan> spans;

    /// Adds what was found in later inputs. `continued`: the first of them is the last one of these facts,
    /// of which it has a later part.
    void join(ScanFacts later, bool continued = false);
    std::vector<std::byte> save() const;
    static Result<ScanFacts> restore(std::span<const std::byte> record);
};

/// Returns the smallest cube at `min` that contains a box. Errors: coordinates too far apart for any cube.
Result<Cube> root_cube(const glm::dvec3& min, const glm::dvec3& max);

/// Some of the inputs, [first, end). Of the first and the last one it may be a part
/// (io/formats/common/divisible.h).
struct InputRange {
    static constexpr uint64_t kToTheEnd = ~uint64_t{0};

    size_t first = 0, end = 0;
    uint64_t first_point = 0;        ///< of the first input
    uint64_t end_point = kToTheEnd;  ///< of the last input

    bool empty() const { return first == end; }
    /// The points of an input, [begin, end).
    uint64_t begin_in(size_t input) const { return input == first ? first_point : 0; }
    uint64_t end_in(size_t input) const { return input + 1 == end ? end_point : kToTheEnd; }
    bool whole(size_t input) const { return begin_in(input) == 0 && end_in(input) == kToTheEnd; }
    /// How many of the `points` of an input are in the range.
    uint64_t count_in(size_t input, uint64_t points) const {
        return std::min(end_in(input), points) - std::min(begin_in(input), points);
    }
};

/// Returns a pass over the points of some inputs, in the unified schema, input after input.
Pass pass_over_inputs(const Unifier& inputs, InputRange range, uint64_t batch_bytes);

class EarlyCount;

/// Runs of an input of which a range has a part; empty if there is none in which stations are looked for.
struct PartRuns {
    std::optional<ScanRuns> first_part;  ///< its last input begins there, others go on with it
    std::optional<ScanRuns> later_part;  ///< its first input began elsewhere
};

/// Reads some inputs. `early` and `seen_by` get all points as well. At most `most_stations` are estimated,
/// in inputs that are read as a whole; `parts` gets what is needed for the others.
/// Bounds and root are those of no points if there are none. Errors: unreadable inputs.
Result<ScanFacts> scan_range(const Unifier& inputs, InputRange range, uint64_t batch_bytes,
                             size_t most_stations, EarlyCount* early, const Visit& seen_by,
                             PartRuns* parts = nullptr);
/// Adds the stations that the points of an input show.
void add_stations(ScanFacts& facts, const Unifier& inputs, size_t input, const ScanRuns& runs,
                  size_t most_stations);
/// Completes the facts of the inputs from `first` on: finds the root cube and logs what each input lost.
/// Errors: no points at all, coordinates too far apart for any cube.
Result<void> complete_scan(const Unifier& inputs, size_t first, ScanFacts& facts);
/// Does both, for the inputs from `first` on; the inputs before it only contribute their schemas.
Result<ScanFacts> scan_inputs(const Unifier& inputs, uint64_t batch_bytes, size_t first = 0,
                              EarlyCount* early = nullptr, const Visit& seen_by = {});

}  // namespace lucarne::octree
