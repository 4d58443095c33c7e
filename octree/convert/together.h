#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "io/files/shared_output.h"
#include "octree/cache/writer.h"
#include "octree/cluster/ranks.h"
#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Returns which of the inputs from `first` on this rank reads. The ranks read consecutive inputs with about
/// equally many points: whole ones if that is even enough, else also parts of those that can be divided.
/// Errors: unreadable.
Result<InputRange> inputs_of_rank(const Unifier& inputs, const Ranks& ranks, size_t first = 0);

/// Scans the inputs from `first` on, on all ranks. `early` and `seen_by` get the points of this rank. A
/// meeting.
Result<ScanFacts> scan_together(const Unifier& inputs, InputRange own, uint64_t batch_bytes, Ranks& ranks,
                                size_t first = 0, EarlyCount* early = nullptr, const Visit& seen_by = {});

/// Errors: the ranks run different programs. A meeting.
Result<void> check_program(Ranks& ranks);
/// Errors: the ranks run different programs, or see different inputs or options. A meeting.
Result<void> check_ranks(Ranks& ranks, const BuildOptions& options);
/// Does the same for other options, given as text.
Result<void> check_ranks(Ranks& ranks, std::string_view options,
                         std::span<const io::PointSource* const> inputs);

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
