#include "octree/convert/together.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/core/log_silence.h"
#include "io/core/machine.h"
#include "io/files/file.h"
#include "io/formats/common/divisible.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/convert/chunks/record_bytes.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kGuessedRecord = 32;  ///< bytes of a point in a file that does not say how many it has
constexpr double kEven = 1.25;           ///< the fullest rank's points over the mean

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

/// A place between two points of the inputs.
struct InputPlace {
    size_t input = 0;
    uint64_t point = 0;
};

/// Returns the place behind about `points` points, where reading can begin. `before`: the points before each
/// input, and of all.
Result<InputPlace> place_behind(const Unifier& inputs, std::span<const uint64_t> before, uint64_t points) {
    const auto behind = std::upper_bound(before.begin(), before.end(), points) - before.begin();
    const auto input = static_cast<size_t>(behind) - 1;
    if (input == inputs.inputs()) return InputPlace{input, 0};
    const uint64_t point = points - before[input], all = before[input + 1] - before[input];
    const io::PointSource& source = inputs.source(input);
    const auto* divisible = dynamic_cast<const io::DivisibleSource*>(&source);
    if (const uint64_t declared = source.info().declared_points; divisible && declared > 0) {
        LUCARNE_ASSIGN(const uint64_t cut, divisible->cut(point));
        LUCARNE_ASSIGN(const uint64_t last_cut, divisible->cut(declared - 1));
        if (last_cut > 0) return InputPlace{input, cut};
    }
    return point > all / 2 ? InputPlace{input + 1, 0} : InputPlace{input, 0};
}

/// Returns what each rank reads. A meeting.
Result<std::vector<InputRange>> share_ranges(const InputRange& own, Ranks& ranks) {
    ByteWriter writer;
    writer.put(own);
    LUCARNE_ASSIGN(const auto all, share(ranks, writer.take()));
    std::vector<InputRange> ranges;
    for (const Ranks::Bytes& bytes : all) ranges.push_back(ByteReader(bytes).get<InputRange>());
    return ranges;
}

/// Returns the points that a scan has kept of the part behind another one, as a message.
Ranks::Bytes encode_part(const ScanRuns& runs, uint64_t count) {
    ByteWriter writer;
    writer.put(count);
    writer.put_all(std::vector<glm::vec3>(runs.kept().begin(), runs.kept().end()));
    return writer.take();
}

/// Sends the runs of parts to the ranks that have the first parts of the same inputs. Returns what this rank
/// gets. A meeting.
Result<std::vector<Ranks::Bytes>> gather_parts(const PartRuns& parts, const ScanFacts& found,
                                               std::span<const InputRange> ranges, Ranks& ranks) {
    std::vector<Ranks::Bytes> parcels(ranks.count());
    const size_t input = ranges[ranks.rank()].first;
    if (parts.later_part)
        for (size_t rank = 0; rank < ranks.rank(); ++rank)
            if (const InputRange& range = ranges[rank];
                !range.empty() && range.end == input + 1 && range.begin_in(input) == 0)
                parcels[rank] = encode_part(*parts.later_part, found.inputs[0].points);
    return ranks.exchange(parcels);
}

/// Adds the stations of the last input, of which this rank has read the first part.
Result<void> add_divided(ScanFacts& found, const Unifier& inputs, size_t input, ScanRuns runs,
                         std::span<const Ranks::Bytes> later, size_t most) {
    for (const Ranks::Bytes& part : later) {
        if (part.empty()) continue;
        ByteReader reader(part);
        const auto count = reader.get<uint64_t>();
        runs.join(reader.get_all<glm::vec3>(), count);
        if (!reader.sound()) return failed("the conversion", "has got incomplete points of a part");
    }
    add_stations(found, inputs, input, runs, most);
    return {};
}

}  // namespace

Result<InputRange> inputs_of_rank(const Unifier& inputs, const Ranks& ranks, size_t first_input) {
    std::vector<uint64_t> weights(first_input, 0);
    for (size_t input = first_input; input < inputs.inputs(); ++input) {
        const io::ScanInfo& info = inputs.source(input).info();
        std::error_code unknown;
        uint64_t points = info.declared_points;
        if (points == 0) points = std::filesystem::file_size(info.path, unknown) / kGuessedRecord;
        weights.push_back(unknown ? 1 : points + 1);
    }
    const auto first = divide(weights, ranks.count());
    std::vector<uint64_t> before{0};
    for (const uint64_t weight : weights) before.push_back(before.back() + weight);
    uint64_t most = 0;
    for (size_t rank = 0; rank < ranks.count(); ++rank)
        most = std::max(most, before[first[rank + 1]] - before[first[rank]]);
    const double all = static_cast<double>(before.back()), count = static_cast<double>(ranks.count());
    if (static_cast<double>(most) * count <= kEven * all)
        return InputRange{std::max(first[ranks.rank()], first_input),
                          std::max(first[ranks.rank() + 1], first_input)};
    const auto place = [&](size_t rank) {
        return place_behind(inputs, before, static_cast<uint64_t>(all / count * static_cast<double>(rank)));
    };
    InputPlace begin{first_input, 0}, end{inputs.inputs(), 0};
    if (ranks.rank() > 0) {
        LUCARNE_ASSIGN(begin, place(ranks.rank()));
    }
    if (ranks.rank() + 1 < ranks.count()) {
        LUCARNE_ASSIGN(end, place(ranks.rank() + 1));
    }
    if (begin.input == end.input && begin.point == end.point) return InputRange{begin.input, begin.input};
    if (end.point == 0) return InputRange{begin.input, end.input, begin.point};
    return InputRange{begin.input, end.input + 1, begin.point, end.point};
}

Result<ScanFacts> scan_together(const Unifier& inputs, InputRange own, uint64_t batch_bytes, Ranks& ranks,
                                size_t first, EarlyCount* early, const Visit& seen_by) {
    PartRuns parts;
    const auto scan_own = [&] {
        const log::Speaking about_own_inputs(ranks.rank() > 0);
        return scan_range(inputs, own, batch_bytes, kMostEstimatedStations, early, seen_by, &parts);
    };
    LUCARNE_ASSIGN(ScanFacts found, scan_own());
    LUCARNE_ASSIGN(const auto ranges, share_ranges(own, ranks));
    LUCARNE_ASSIGN(const auto later_parts, gather_parts(parts, found, ranges, ranks));
    if (parts.first_part)
        LUCARNE_TRY(
            add_divided(found, inputs, own.end - 1, *parts.first_part, later_parts, kMostEstimatedStations));
    std::vector<uint64_t> stations(ranks.count(), 0);
    stations[ranks.rank()] = found.stations.size();
    LUCARNE_TRY(ranks.sum(stations));
    size_t room = kMostEstimatedStations;
    for (size_t rank = 0; rank < ranks.rank(); ++rank) room -= std::min(room, stations[rank]);
    if (found.stations.size() > room) {  // which parts a scan's stations saw depends on how many it has
        LUCARNE_ASSIGN(found, scan_range(inputs, own, batch_bytes, room, nullptr, {}));
        if (parts.first_part)
            LUCARNE_TRY(add_divided(found, inputs, own.end - 1, *parts.first_part, later_parts, room));
    }
    LUCARNE_ASSIGN(const auto all, share(ranks, found.save()));
    LUCARNE_ASSIGN(ScanFacts facts, ScanFacts::restore(all[0]));
    for (size_t rank = 1; rank < all.size(); ++rank) {
        LUCARNE_ASSIGN(auto later, ScanFacts::restore(all[rank]));
        facts.join(std::move(later), ranges[rank].first_point > 0);
    }
    LUCARNE_TRY(complete_scan(inputs, first, facts));
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
    return check_ranks(ranks,
                       fmt::format("{} {} {} {} {} {}", options.memory, static_cast<int>(options.normals),
                                   options.neighbours, static_cast<int>(options.neighbour_search),
                                   options.fill, options.read_options),
                       options.inputs);
}

Result<void> check_ranks(Ranks& ranks, std::string_view options,
                         std::span<const io::PointSource* const> inputs) {
    LUCARNE_TRY(check_program(ranks));
    LUCARNE_TRY(check_same(ranks, "--memory or another option", std::string(options)));
    std::string seen;
    for (const auto* input : inputs) {
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
