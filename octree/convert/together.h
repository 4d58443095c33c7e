#pragma once

#include <optional>

#include "io/files/shared_output.h"
#include "octree/cache/writer.h"
#include "octree/cluster/ranks.h"
#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Returns the inputs that this rank reads. The ranks read consecutive inputs with about equally many points:
/// whole ones if that is even enough, else also parts of those that can be divided. Errors: unreadable.
Result<InputRange> inputs_of_rank(const Unifier& inputs, const Ranks& ranks);

/// Scans the inputs on all ranks. `seen` gets the points of this rank. `counted` becomes the counts of this
/// rank's points for the chunks, on all ranks or on none. A meeting.
Result<ScanFacts> scan_together(const Unifier& inputs, InputRange own, const MemoryPlan& memory, Ranks& ranks,
                                const Visit& seen, std::optional<CountGrid>& counted);

/// Errors: the ranks run different programs. A meeting.
Result<void> check_program(Ranks& ranks);
/// Errors: the ranks run different programs, or see different inputs or options. A meeting.
Result<void> check_ranks(Ranks& ranks, const BuildOptions& options);

/// The file that all ranks write.
struct SharedCache {
    std::optional<SharedOutput> output;
    std::optional<CacheWriter> writer;  ///< at rank 0: its name, directory and superblocks

    /// Errors: those of CacheWriter::create_shared; another rank does not see the file. A meeting.
    static Result<SharedCache> create(Ranks& ranks, const BuildOptions& options,
                                      const std::filesystem::path& temp_folder);
};

/// Replaces the CPU times of the stages by their sums over all ranks. A meeting.
Result<void> sum_cpu(Ranks& ranks, std::vector<StageTime>& stages);

}  // namespace lucarne::octree
