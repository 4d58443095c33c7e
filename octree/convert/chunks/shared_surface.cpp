// Estimating normals on several ranks: each estimates those of its chunks, and rank 0 joins the orientation.
#include <algorithm>
#include <cmath>

#include "octree/convert/chunks/record_bytes.h"
#include "octree/convert/chunks/surface_store.h"
#include "octree/normals/estimate_range.h"

namespace lucarne::octree {
namespace {

using Bytes = Ranks::Bytes;

Bytes encode_votes(const std::vector<ChunkVotes>& chunks) {
    ByteWriter writer;
    for (const ChunkVotes& chunk : chunks) {
        writer.put_all(chunk.components);
        writer.put_all(chunk.votes);
        writer.put_all(chunk.discs);
    }
    return writer.take();
}

/// Joins the votes of all ranks. Returns the signs of the chunks in `own`; those of others are empty. A
/// meeting.
Result<OrientationSigns> join_votes(Ranks& ranks, const std::vector<ChunkVotes>& votes, ChunkRange own,
                                    const ChunkAccess& access, uint64_t memory,
                                    const std::function<size_t(size_t)>& owner) {
    const size_t chunks = access.chunk_count();
    LUCARNE_ASSIGN(auto all, tell_first(ranks, encode_votes(votes)));
    std::vector<Bytes> parcels(ranks.count());
    if (ranks.rank() == 0) {
        OrientationMerger merger(OrientationDetail::of(access, memory));
        size_t chunk = 0;
        for (size_t rank = 0; rank < all.size(); ++rank) {
            ByteReader reader(all[rank]);
            for (; chunk < chunks && owner(chunk) == rank; ++chunk) {
                ChunkVotes part;
                part.components = reader.get_all<ChunkVotes::Component>();
                part.votes = reader.get_all<ComponentVote>();
                part.discs = reader.get_all<SightDisc>();
                merger.add(part);
            }
            Bytes().swap(all[rank]);
        }
        const auto signs = merger.signs();
        std::vector<ByteWriter> writers(ranks.count());
        for (size_t i = 0; i < signs.size(); ++i) writers[owner(i)].put_all(signs[i]);
        for (size_t rank = 0; rank < parcels.size(); ++rank) parcels[rank] = writers[rank].take();
    }
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    ByteReader reader(received[0]);
    OrientationSigns signs(chunks);
    for (size_t chunk = own.first; chunk < own.end; ++chunk) signs[chunk] = reader.get_all<int32_t>();
    return signs;
}

/// Sends the messages to the ranks that have the chunks, and returns those for this rank's chunks: by chunk,
/// those to one chunk in the order of the chunks that sent them. A meeting.
Result<std::vector<BorderMessage>> deliver(Ranks& ranks, const std::vector<BorderMessage>& outgoing,
                                           const std::function<size_t(size_t)>& owner) {
    std::vector<ByteWriter> writers(ranks.count());
    for (const BorderMessage& message : outgoing) writers[owner(message.to)].put(message);
    std::vector<Bytes> parcels;
    for (ByteWriter& writer : writers) parcels.push_back(writer.take());
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    std::vector<BorderMessage> messages;
    for (const Bytes& parcel : received) {
        ByteReader reader(parcel);
        for (size_t i = 0; i < parcel.size() / sizeof(BorderMessage); ++i)
            messages.push_back(reader.get<BorderMessage>());
    }
    std::ranges::stable_sort(messages, {}, [](const BorderMessage& message) { return message.to; });
    return messages;
}

}  // namespace

Result<void> SurfaceStore::estimate_together(const ChunkStore& chunks, const ChunkAccess& access,
                                             const NormalOptions& options,
                                             const std::function<Result<void>(size_t, ChunkNormals&&)>& keep,
                                             const Settings& settings) {
    const ChunkRange own = chunks.own();
    Ranks& ranks = *settings.ranks;
    LUCARNE_ASSIGN(ScratchFile sites, ScratchFile::create(settings.folder));
    NormalOptions with_sites = options;
    with_sites.site_normals = true;
    const auto keep_both = [&](size_t chunk, ChunkNormals&& found) -> Result<void> {
        if (ranks.stopped()) return failed("the conversion", "has failed on another rank");
        LUCARNE_TRY(
            sites.write_at(first_[chunk] * sizeof(glm::vec3), std::as_bytes(std::span(found.site_normals))));
        return keep(chunk, std::move(found));
    };
    std::vector<ChunkVotes> votes;
    LUCARNE_ASSIGN(const auto outgoing,
                   estimate_range(access, own, with_sites, keep_both,
                                  [&](ChunkVotes&& of_chunk) { votes.push_back(std::move(of_chunk)); }));
    LUCARNE_TRY(sum_areas(ranks));
    const auto owner = [&](size_t chunk) { return chunks.owner(chunk); };
    LUCARNE_ASSIGN(const auto messages, deliver(ranks, outgoing, owner));
    for (size_t first = 0, last; first < messages.size(); first = last) {
        const uint32_t chunk = messages[first].to;
        for (last = first; last < messages.size() && messages[last].to == chunk;) ++last;
        LUCARNE_ASSIGN(const auto points, read(chunk, 0, count(chunk)));
        std::vector<glm::vec3> normals(points.size());
        LUCARNE_TRY(
            sites.read_at(first_[chunk] * sizeof(glm::vec3), std::as_writable_bytes(std::span(normals))));
        VoteSums heard;
        for (size_t i = first; i < last; ++i) {
            const uint32_t point = messages[i].index;
            if (normals[point] != glm::vec3(0.0f))
                heard.add(messages[i].heard(normals[point], points[point].component));
        }
        auto all = heard.take();
        auto& known = votes[chunk - own.first].votes;
        all.insert(all.end(), known.begin(), known.end());
        known = std::move(all);
    }
    LUCARNE_ASSIGN(signs_, join_votes(ranks, votes, own, access, options.memory, owner));
    return {};
}

/// Replaces the histogram by that of all ranks. A meeting.
Result<void> SurfaceStore::sum_areas(Ranks& ranks) {
    ByteWriter writer;
    for (const auto& [bin, count] : areas_) {
        writer.put(int64_t{bin});
        writer.put(count);
    }
    LUCARNE_ASSIGN(const auto all, share(ranks, writer.take()));
    areas_.clear();
    for (const Bytes& part : all) {
        ByteReader reader(part);
        for (size_t i = 0; i < part.size() / (2 * sizeof(uint64_t)); ++i) {
            const auto bin = static_cast<int>(reader.get<int64_t>());
            areas_[bin] += reader.get<uint64_t>();
        }
    }
    return {};
}

}  // namespace lucarne::octree
