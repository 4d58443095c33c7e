#include "octree/convert/together.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/core/log_silence.h"
#include "io/core/machine.h"
#include "io/files/file.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/convert/scans/early_count.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kGuessedRecord = 32;  ///< bytes of a point in a file that does not say how many it has

/// Returns the checksum of the running program. Two builds may have the same version and revision.
Result<uint64_t> program_sum() {
    LUCARNE_ASSIGN(const auto program, InputFile::open("/proc/self/exe"));
    constexpr uint64_t kPiece = 1 << 20;
    std::vector<std::byte> piece;
    std::vector<uint64_t> sums;
    for (uint64_t at = 0; at < program.size(); at += piece.size()) {
        piece.resize(std::min(kPiece, program.size() - at));
        LUCARNE_TRY(program.read_at(at, piece));
        sums.push_back(format::checksum(piece));
    }
    return format::checksum(std::as_bytes(std::span(sums)));
}

}  // namespace

InputRange inputs_of_rank(const Unifier& inputs, const Ranks& ranks) {
    std::vector<uint64_t> weights;
    for (size_t input = 0; input < inputs.inputs(); ++input) {
        const io::ScanInfo& info = inputs.source(input).info();
        std::error_code unknown;
        uint64_t points = info.declared_points;
        if (points == 0) points = std::filesystem::file_size(info.path, unknown) / kGuessedRecord;
        weights.push_back(unknown ? 1 : points + 1);
    }
    const auto first = divide(weights, ranks.count());
    return {first[ranks.rank()], first[ranks.rank() + 1]};
}

Result<ScanFacts> scan_together(const Unifier& inputs, InputRange own, const MemoryPlan& memory, Ranks& ranks,
                                const Visit& seen, std::optional<CountGrid>& counted) {
    EarlyCount early(inputs, memory.grid_bytes);
    const auto scan_own = [&] {
        const log::Speaking about_own_inputs(ranks.rank() > 0);
        return scan_range(inputs, own, memory.batch_bytes, kMostEstimatedStations, &early, seen);
    };
    LUCARNE_ASSIGN(ScanFacts found, scan_own());
    std::vector<uint64_t> stations(ranks.count(), 0);
    stations[ranks.rank()] = found.stations.size();
    LUCARNE_TRY(ranks.sum(stations));
    size_t room = kMostEstimatedStations;
    for (size_t rank = 0; rank < ranks.rank(); ++rank) room -= std::min(room, stations[rank]);
    if (found.stations.size() > room) {  // which parts a scan's stations saw depends on how many it has
        LUCARNE_ASSIGN(found, scan_range(inputs, own, memory.batch_bytes, room, nullptr, {}));
    }
    LUCARNE_ASSIGN(const auto all, share(ranks, found.save()));
    LUCARNE_ASSIGN(ScanFacts facts, ScanFacts::restore(all[0]));
    for (size_t rank = 1; rank < all.size(); ++rank) {
        LUCARNE_ASSIGN(auto later, ScanFacts::restore(all[rank]));
        facts.join(std::move(later));
    }
    LUCARNE_TRY(complete_scan(inputs, 0, facts));
    counted = early.take(facts);
    uint64_t have = counted ? 1 : 0;
    LUCARNE_TRY(ranks.sum({&have, 1}));
    if (have < ranks.count()) counted.reset();
    return facts;
}

Result<void> check_program(Ranks& ranks) {
    const BuildInfo built = build_info();
    LUCARNE_ASSIGN(const uint64_t sum, program_sum());
    return check_same(ranks, "lucarne-mpi",
                      fmt::format("version {} {} format {} program {:016x}", built.version, built.revision,
                                  format::kVersion, sum));
}

Result<void> check_ranks(Ranks& ranks, const BuildOptions& options) {
    LUCARNE_TRY(check_program(ranks));
    LUCARNE_TRY(check_same(ranks, "--memory or another option",
                           fmt::format("{} {} {} {} {} {}", options.memory, static_cast<int>(options.normals),
                                       options.neighbours, static_cast<int>(options.neighbour_search),
                                       options.fill, options.read_options)));
    std::string seen;
    for (const auto* input : options.inputs) {
        SourceHeader header{.schema = input->schema()};
        header.scans.push_back(input->info());
        const std::string facts = metadata_text(header);
        seen += fmt::format("{} {:016x}\n", input->info().path,
                            format::checksum(std::as_bytes(std::span(facts))));
    }
    return check_same(ranks, "inputs",
                      fmt::format("{:016x}", format::checksum(std::as_bytes(std::span(seen)))));
}

Result<SharedCache> SharedCache::create(Ranks& ranks, const BuildOptions& options,
                                        const std::filesystem::path& temp_folder) {
    std::optional<CacheWriter> writer;
    if (ranks.rank() == 0) {
        LUCARNE_ASSIGN(writer, CacheWriter::create_shared(options.output, options.overwrite, temp_folder));
    }
    LUCARNE_TRY(meet(ranks));
    LUCARNE_ASSIGN(auto output, SharedOutput::open(options.output));
    return SharedCache{std::move(output), std::move(writer)};
}

Result<void> sum_cpu(Ranks& ranks, std::vector<StageTime>& stages) {
    constexpr double kMicro = 1e6;
    std::vector<uint64_t> cpu;
    for (const StageTime& stage : stages)
        cpu.push_back(static_cast<uint64_t>(std::llround(kMicro * std::max(0.0, stage.cpu_seconds))));
    LUCARNE_TRY(ranks.sum(cpu));
    for (size_t i = 0; i < stages.size(); ++i) stages[i].cpu_seconds = static_cast<double>(cpu[i]) / kMicro;
    return {};
}

}  // namespace lucarne::octree
