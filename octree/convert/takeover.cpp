#include "octree/convert/takeover.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/core/log.h"
#include "octree/cluster/ranks.h"
#include "octree/convert/build_inputs.h"
#include "octree/convert/chunks/record_bytes.h"
#include "octree/convert/chunks/surface_store.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {
namespace {

constexpr size_t kNowhere = ~size_t{0};

std::string ranks_text(size_t count) {
    return count == 1 ? "one process" : fmt::format("{} ranks", count);
}

/// What is left of one rank, as far as its checksums are right.
struct Part {
    Workspace* work = nullptr;
    ChunkStore chunks;
    std::optional<SurfaceStore> surface;
};

/// What others are told of it.
struct Offer {
    uint64_t rank = 0, count = 0;
    uint64_t ended = 0;           ///< 1: it was noted that its cache is complete
    uint64_t sound = 0;           ///< 1: has finished chunks; what follows is about them
    uint64_t first = 0, end = 0;  ///< its chunks
    uint64_t normals = 0;         ///< 1: has them
};

/// Whether a build of these facts estimates normals or areas, and its chunks have stations.
struct Wanted {
    bool surface = false, stations = false;
};
Result<Wanted> wanted(const BuildOptions& options, const Unifier& inputs, const ScanFacts& facts) {
    LUCARNE_ASSIGN(const auto normals, wanted_normals(options.normals, inputs, facts.without_normal == 0));
    return Wanted{normals.has_value(), normals && !facts.spans.empty()};
}

Result<Part> restore(Workspace& work, const Unifier& inputs, const BuildOptions& options) {
    const auto *scan = work.finished("scan"), *chunk = work.finished("chunk"),
               *normals = work.finished("normals");
    if (!scan || !chunk) return failed("chunks", "were not finished");
    LUCARNE_ASSIGN(const ScanFacts facts, ScanFacts::restore(*scan));
    LUCARNE_ASSIGN(const Wanted want, wanted(options, inputs, facts));
    LUCARNE_ASSIGN(ScratchFile points, work.scratch("points", true));
    LUCARNE_ASSIGN(ChunkStore chunks, ChunkStore::restore(std::move(points), inputs.schema(), facts.root,
                                                          want.stations, *chunk));
    Part part{&work, std::move(chunks), {}};
    if (!normals) return part;
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("normals", true));
    if (auto surface = SurfaceStore::restore(part.chunks, std::move(file), *normals))
        part.surface = std::move(*surface);
    return part;
}

/// The parts of one build, by the rank that had them.
struct Build {
    std::vector<size_t> holders;  ///< the rank that has a sound part now
    std::vector<Offer> offers;
    std::vector<bool> found;  ///< there is a part, sound or not
    bool normals = true;
    bool ended = false;  ///< its cache was complete, and parts may have been removed

    explicit Build(uint64_t count) : holders(count, kNowhere), offers(count), found(count) {}
    /// Returns the ranks that have no sound part.
    std::vector<size_t> unsound() const {
        std::vector<size_t> ranks;
        for (size_t rank = 0; rank < holders.size(); ++rank)
            if (holders[rank] == kNowhere) ranks.push_back(rank);
        return ranks;
    }
    /// Returns the ranks that have no part at all.
    std::vector<size_t> missing() const {
        std::vector<size_t> ranks;
        for (size_t rank = 0; rank < found.size(); ++rank)
            if (!found[rank]) ranks.push_back(rank);
        return ranks;
    }
};

/// Tells all ranks what each has. Returns the builds by their number of ranks. Two sound parts of the same
/// rank have the same bytes. A meeting.
Result<std::map<uint64_t, Build>> compare(Ranks& ranks, const Workspace& work,
                                          const std::vector<Workspace>& left,
                                          const std::vector<Part>& parts) {
    ByteWriter writer;
    const auto found = [&](const Workspace& known) {
        Offer offer{.rank = known.part().rank, .count = known.part().count, .ended = known.ended() ? 1u : 0u};
        if (known.finished("scan")) writer.put(offer);
    };
    found(work);
    for (const Workspace& other : left) found(other);
    for (const Part& part : parts) {
        const auto [rank, count] = part.work->part();
        writer.put(Offer{rank, count, part.work->ended() ? 1u : 0u, 1, part.chunks.own().first,
                         part.chunks.own().end, part.surface ? uint64_t{1} : 0});
    }
    LUCARNE_ASSIGN(const auto all, share(ranks, writer.take()));
    std::map<uint64_t, Build> builds;
    for (size_t holder = 0; holder < all.size(); ++holder)
        for (ByteReader reader(all[holder]); reader.left() > 0;) {
            const auto offer = reader.get<Offer>();
            Build& build = builds.try_emplace(offer.count, offer.count).first->second;
            build.found[offer.rank] = true;
            if (offer.ended != 0) build.ended = true;
            if (offer.sound == 0) continue;
            // A kill while parts were moved may leave two of one rank; that with normals has come farther.
            if (build.holders[offer.rank] != kNowhere && offer.normals <= build.offers[offer.rank].normals)
                continue;
            build.holders[offer.rank] = holder;
            build.offers[offer.rank] = offer;
        }
    for (auto& [count, build] : builds)
        build.normals =
            std::ranges::all_of(build.offers, [](const Offer& offer) { return offer.normals != 0; });
    return builds;
}

/// Returns the whole build that has come farthest, if there is one.
const Build* best(const std::map<uint64_t, Build>& builds) {
    const Build* found = nullptr;
    for (const auto& [count, build] : builds) {
        bool whole = build.unsound().empty();
        for (size_t rank = 0; rank + 1 < count && whole; ++rank)
            whole = build.offers[rank].end == build.offers[rank + 1].first;
        if (whole && (!found || (build.normals && !found->normals))) found = &build;
    }
    return found;
}

std::string why_not(const std::map<uint64_t, Build>& builds) {
    if (builds.empty())
        return "it has finished no stage that can be taken over, or all its files are damaged";
    const auto& [count, build] = *builds.begin();
    return fmt::format("of {}, the scratch files of rank {} are lost or damaged", ranks_text(count),
                       fmt::join(build.unsound(), ", "));
}

/// Errors: a build has finished chunks, and the parts of some ranks are on no machine that takes part.
Result<void> check_present(const std::map<uint64_t, Build>& builds) {
    for (const auto& [count, build] : builds)
        if (const auto missing = build.missing();
            !build.ended && !missing.empty() && build.unsound().size() < count)
            return failed("--resume",
                          fmt::format("of the interrupted conversion by {}, the work folder of rank {} is on "
                                      "no machine that takes part, or its journal is damaged",
                                      ranks_text(count), fmt::join(missing, ", ")),
                          "bring its machine back, or leave --resume out to begin anew");
    return {};
}

/// What a rank without a part must know of the build.
struct Common {
    std::vector<std::byte> scan;
    std::vector<Chunk> chunks;
};
Result<Common> hear_common(Ranks& ranks, size_t holder, const Part* first) {
    std::vector<Ranks::Bytes> parcels(ranks.count());
    if (first) {
        ByteWriter writer;
        writer.put_all(*first->work->finished("scan"));
        const auto chunks = first->chunks.chunks();
        writer.put_all(std::vector<Chunk>(chunks.begin(), chunks.end()));
        std::ranges::fill(parcels, writer.take());
    }
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    ByteReader reader(received[holder]);
    Common common;
    common.scan = reader.get_all<std::byte>();
    common.chunks = reader.get_all<Chunk>();
    if (!reader.sound()) return failed("the conversion", "has got incomplete chunks");
    return common;
}

/// Moves the parts of `build` to the ranks that get their chunks, and records the stages. A meeting.
Result<void> move(Workspace& work, Ranks& ranks, const Build& build, const std::vector<Part>& parts,
                  const Unifier& inputs, const BuildOptions& options, const MemoryPlan& memory) {
    std::vector<const ChunkStore*> chunks;
    std::vector<SurfaceStore::Part> surfaces;
    const Part* first = nullptr;
    std::vector<bool> taken(build.holders.size());  // this rank may hold two parts of one rank
    for (const Part& part : parts) {
        const auto [rank, count] = part.work->part();
        if (count != build.holders.size() || build.holders[rank] != ranks.rank() || taken[rank]) continue;
        if (build.normals && !part.surface) continue;
        taken[rank] = true;
        if (rank == 0) first = &part;
        chunks.push_back(&part.chunks);
        if (build.normals) surfaces.push_back({&part.chunks, &*part.surface});
    }
    LUCARNE_ASSIGN(const Common common, hear_common(ranks, build.holders[0], first));
    LUCARNE_ASSIGN(const ScanFacts facts, ScanFacts::restore(common.scan));
    LUCARNE_ASSIGN(const Wanted want, wanted(options, inputs, facts));
    LUCARNE_TRY(work.finish("scan", common.scan));
    LUCARNE_ASSIGN(ScratchFile points, work.scratch("points", false));
    ChunkStore store(std::move(points), inputs.schema(), facts.root, want.stations);
    LUCARNE_TRY(store.take_over(chunks, common.chunks, memory, ranks));
    LUCARNE_TRY(work.finish("chunk", store.save()));
    if (!build.normals || !want.surface) return {};
    LUCARNE_ASSIGN(ScratchFile file, work.scratch("normals", false));
    LUCARNE_ASSIGN(const SurfaceStore surface,
                   SurfaceStore::take_over(surfaces, store, std::move(file), memory, ranks));
    return work.finish("normals", surface.save());
}

}  // namespace

Result<void> take_over(Workspace& work, std::vector<Workspace>& left, Ranks& ranks, const Unifier& inputs,
                       const BuildOptions& options, const MemoryPlan& memory) {
    std::array<uint64_t, 3> seen{left.size(), work.finished("chunk") ? 1u : 0u, work.resumable() ? 1u : 0u};
    LUCARNE_TRY(ranks.sum(seen));
    if (seen[0] + seen[1] > 0 && seen[2] < ranks.count())
        return failed("--resume", "a rank cannot use its work folder",
                      "mend what that rank reports, or leave --resume out to begin anew");
    bool anew = false;
    // These ranks have chunks of their own, and there is nothing that may have come farther.
    const bool further = seen[1] == ranks.count() && seen[0] == 0;
    if (!further && seen[0] + seen[1] > 0) {
        left.reserve(left.size() + 1);  // parts point into it
        std::vector<Part> parts;
        for (Workspace& other : left)
            if (auto part = restore(other, inputs, options)) parts.push_back(std::move(*part));
        auto own = restore(work, inputs, options);
        const bool has_own = own.has_value();
        if (has_own) parts.push_back(std::move(*own));
        LUCARNE_ASSIGN(const auto builds, compare(ranks, work, left, parts));
        if (const Build* build = best(builds)) {
            if (ranks.rank() == 0)
                log::info("going on after '{}' of the interrupted conversion by {}",
                          build->normals ? "normals" : "chunk", ranks_text(build->holders.size()));
            if (has_own) {
                LUCARNE_ASSIGN(Workspace before, work.set_aside());
                left.push_back(std::move(before));
                parts.back().work = &left.back();
            }
            LUCARNE_TRY(move(work, ranks, *build, parts, inputs, options, memory));
        } else {
            LUCARNE_TRY(check_present(builds));
            const auto own_build = builds.find(ranks.count());
            anew = own_build != builds.end() && own_build->second.ended;
            const bool ended = !builds.empty() &&
                               std::ranges::all_of(builds, [](const auto& of) { return of.second.ended; });
            if (ranks.rank() == 0 && seen[0] > 0 && !ended)
                log::warn("the interrupted conversion cannot go on, starting from the beginning: {}",
                          why_not(builds));
        }
    }
    LUCARNE_TRY(meet(ranks));
    // What is left was taken over, or cannot be.
    for (Workspace& other : left) other.end();
    LUCARNE_TRY(meet(ranks));
    for (Workspace& other : left) other.done();
    left.clear();
    return anew ? work.begin_anew() : work.reopen();
}

}  // namespace lucarne::octree
