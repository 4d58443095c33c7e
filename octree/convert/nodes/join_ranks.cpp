#include "octree/convert/nodes/join_ranks.h"

#include <algorithm>
#include <functional>

#include "octree/convert/chunks/record_bytes.h"

namespace lucarne::octree {
namespace {

using Bytes = Ranks::Bytes;

constexpr uint64_t kEntriesAtATime = 16384;      // 1 MiB
constexpr uint64_t kCopied = uint64_t{8} << 20;  ///< bytes copied at a time
constexpr uint64_t kAsked = uint64_t{1} << 20;   ///< bytes of payloads in an answer, held by both ranks

enum class Wanted : uint64_t { loose, sample, entries, payloads };
struct NodeQuestion {
    Wanted wanted = Wanted::loose;
    uint64_t first = 0, count = 0;  ///< of entries or of bytes; `first` is also the index of a sample
};

/// Where a part of a rank's payloads goes.
struct Placed {
    uint64_t from = 0, bytes = 0, to = 0;
};

Result<Bytes> answer(const CacheWriter& staged, const Assembler& own, std::span<const std::byte> bytes) {
    ByteReader reader(bytes);
    const auto question = reader.get<NodeQuestion>();
    switch (question.wanted) {
        case Wanted::loose: {
            ByteWriter writer;
            writer.put_all(own.loose());
            return writer.take();
        }
        case Wanted::sample:
            return own.loose_sample(question.first);
        case Wanted::entries:
            return staged.entries(question.first, question.count);
        case Wanted::payloads: {
            Bytes payloads(question.count);
            LUCARNE_TRY(staged.read_at(question.first, payloads));
            return payloads;
        }
    }
    return failed("the conversion", "a rank asked for something unknown");
}

Result<Bytes> ask(Ranks& ranks, size_t rank, const NodeQuestion& question) {
    ByteWriter writer;
    writer.put(question);
    return ranks.ask(rank, writer.take());
}

/// Adds the nodes of one rank from `first` to `end`, whose payloads are moved by `move`.
Result<void> add_entries(Ranks& ranks, size_t rank, uint64_t first, uint64_t end, uint64_t move,
                         CacheWriter& cache) {
    for (; first < end; first += std::min(kEntriesAtATime, end - first)) {
        LUCARNE_ASSIGN(const auto entries,
                       ask(ranks, rank, {Wanted::entries, first, std::min(kEntriesAtATime, end - first)}));
        for (size_t at = 0; at + format::kEntryBytes <= entries.size(); at += format::kEntryBytes) {
            auto entry = format::load_entry(&entries[at]);
            if (entry.payload_offset & kStays)
                entry.payload_offset -= kStays;
            else
                entry.payload_offset += move;
            LUCARNE_TRY(cache.add(entry));
        }
    }
    return {};
}

/// Takes payloads of a rank, `bytes` from an offset on, into the cache. Returns where they go.
using TakePayloads = std::function<Result<uint64_t>(size_t rank, uint64_t from, uint64_t bytes)>;

/// Assembles what is above the nodes of single ranks.
Result<void> assemble_top(Ranks& ranks, CacheWriter& cache, Assembler& top, const TakePayloads& take) {
    std::vector<std::vector<Assembler::Loose>> loose;
    std::vector<NodeKey> roots;
    for (size_t rank = 0; rank < ranks.count(); ++rank) {
        LUCARNE_ASSIGN(const auto list, ask(ranks, rank, {}));
        loose.push_back(ByteReader(list).get_all<Assembler::Loose>());
        for (const auto& one : loose.back()) roots.push_back(one.node.key);
    }
    size_t next = 0;
    for (size_t rank = 0; rank < ranks.count(); ++rank) {
        uint64_t payloads = 0, nodes = 0;
        for (size_t i = 0; i < loose[rank].size(); ++i) {
            const auto& one = loose[rank][i];
            LUCARNE_ASSIGN(const uint64_t to, take(rank, payloads, one.payload_end - payloads));
            LUCARNE_TRY(add_entries(ranks, rank, nodes, one.nodes, to - payloads, cache));
            payloads = one.payload_end;
            nodes = one.nodes;
            Subtree subtree{.root = one.node};
            LUCARNE_ASSIGN(subtree.sample, ask(ranks, rank, {Wanted::sample, i}));
            ++next;
            LUCARNE_TRY(top.add(std::move(subtree), next < roots.size() ? &roots[next] : nullptr));
        }
    }
    return {};
}

Result<void> copy(const CacheWriter& staged, std::span<const Placed> parts, SharedOutput& output) {
    std::vector<std::byte> block;
    for (const Placed& part : parts)
        for (uint64_t done = 0; done < part.bytes; done += block.size()) {
            block.resize(std::min(kCopied, part.bytes - done));
            LUCARNE_TRY(staged.read_at(part.from + done, block));
            LUCARNE_TRY(output.write_at(part.to + done, block));
        }
    return output.sync();
}

}  // namespace

Result<double> join_ranks(Ranks& ranks, const RankNodes& nodes, CacheWriter* cache, SharedOutput& output,
                          const std::filesystem::path& temp_folder) {
    CacheWriter& staged = nodes.staged;
    LUCARNE_TRY(staged.flush_entries());
    LUCARNE_TRY(meet(ranks));  // nobody answers the questions of an earlier stage any more
    std::vector<Bytes> parcels(ranks.count());
    const Serving answers(ranks, [&](std::span<const std::byte> question) {
        return answer(staged, nodes.assembler, question);
    });
    double seconds = 0;
    if (cache) {
        LUCARNE_ASSIGN(Assembler top, Assembler::create(*cache, nodes.loader, nodes.limits, temp_folder));
        std::vector<std::vector<Placed>> placed(ranks.count());
        const auto place = [&](size_t rank, uint64_t from, uint64_t bytes) -> Result<uint64_t> {
            const uint64_t to = cache->reserve(bytes);
            if (bytes > 0) placed[rank].push_back({from, bytes, to});
            return to;
        };
        LUCARNE_TRY(assemble_top(ranks, *cache, top, place));
        for (size_t rank = 0; rank < parcels.size(); ++rank) {
            ByteWriter writer;
            writer.put_all(placed[rank]);
            parcels[rank] = writer.take();
        }
        seconds = top.encode_seconds();
    }
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    const auto parts = ByteReader(received[0]).get_all<Placed>();
    LUCARNE_TRY(copy(staged, parts, output));
    LUCARNE_TRY(meet(ranks));
    return nodes.assembler.encode_seconds() + seconds;
}

Result<void> join_at_first(Ranks& ranks, const RankNodes& nodes, CacheWriter* cache,
                           const std::filesystem::path& temp_folder) {
    LUCARNE_TRY(nodes.staged.flush_entries());
    LUCARNE_TRY(meet(ranks));  // nobody answers the questions of an earlier stage any more
    const Serving answers(ranks, [&](std::span<const std::byte> question) {
        return answer(nodes.staged, nodes.assembler, question);
    });
    if (cache) {
        LUCARNE_ASSIGN(Assembler top, Assembler::create(*cache, nodes.loader, nodes.limits, temp_folder));
        const auto fetch = [&](size_t rank, uint64_t from, uint64_t bytes) -> Result<uint64_t> {
            const uint64_t to = cache->bytes(), end = from + bytes;
            for (; from < end; from += std::min(kAsked, end - from)) {
                LUCARNE_ASSIGN(const auto payloads,
                               ask(ranks, rank, {Wanted::payloads, from, std::min(kAsked, end - from)}));
                LUCARNE_TRY(cache->append(payloads));
            }
            return to;
        };
        LUCARNE_TRY(assemble_top(ranks, *cache, top, fetch));
    }
    return meet(ranks);
}

}  // namespace lucarne::octree
