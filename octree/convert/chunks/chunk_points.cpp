#include "octree/convert/chunks/chunk_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "octree/convert/chunks/record_bytes.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kPieceBytes = uint64_t{1} << 18;  ///< of records read at a time

struct FarQuestion {
    uint64_t chunk = 0;
    Box box;
};

}  // namespace

template <typename Use>
Result<void> ChunkPoints::for_each_record(size_t chunk, const Use& use) const {
    const size_t stride = store_.schema().stride;
    const uint64_t count = point_count(chunk), piece = std::max<uint64_t>(1, kPieceBytes / stride);
    for (uint64_t first = 0; first < count; first += piece) {
        LUCARNE_ASSIGN(const auto records, store_.load(chunk, first, std::min(piece, count - first)));
        for (size_t at = 0; at < records.size(); at += stride) use(&records[at]);
    }
    return {};
}

Result<std::vector<glm::dvec3>> ChunkPoints::positions(size_t chunk) const {
    std::vector<glm::dvec3> positions;
    positions.reserve(point_count(chunk));
    LUCARNE_TRY(for_each_record(chunk, [&](const std::byte* record) {
        positions.push_back(io::position_of(store_.schema(), record));
    }));
    return positions;
}

Result<std::vector<int32_t>> ChunkPoints::stations(size_t chunk) const {
    if (all_stations().empty()) return std::vector<int32_t>(point_count(chunk), -1);
    std::vector<int32_t> result;
    result.reserve(point_count(chunk));
    LUCARNE_TRY(
        for_each_record(chunk, [&](const std::byte* record) { result.push_back(station_of(record)); }));
    return result;
}

int32_t ChunkPoints::station_of(const std::byte* record) const {
    if (const int32_t station = ids_.of(record); station >= 0) return station;
    const int32_t estimated = store_.estimated_station(record);
    return estimated < 0 ? -1 : static_cast<int32_t>(ids_.stated()) + estimated;
}

/// The answer holds, for each point, its index and its position as stored.
Result<std::optional<ChunkAccess::Part>> ChunkPoints::far_points(size_t chunk, const Box& box) const {
    if (!ranks_ || store_.own().contains(chunk)) return std::nullopt;
    ByteWriter question;
    question.put(FarQuestion{chunk, box});
    LUCARNE_ASSIGN(const auto answer, ranks_->ask(store_.owner(chunk), question.take()));
    const size_t bytes = sizeof(uint32_t) + io::position_bytes(store_.schema().position);
    Part part;
    for (size_t at = 0; at + bytes <= answer.size(); at += bytes) {
        part.indices.push_back(io::load<uint32_t>(&answer[at]));
        part.positions.push_back(io::position_of(store_.schema(), &answer[at + sizeof(uint32_t)]));
    }
    return part;
}

Result<Ranks::Bytes> ChunkPoints::answer(std::span<const std::byte> question) const {
    ByteReader reader(question);
    const auto [chunk, box] = reader.get<FarQuestion>();
    if (!reader.sound() || !store_.own().contains(chunk))
        return failed("the conversion", "a rank asked for a chunk of another one");
    // A little wider, because the asker compares scaled positions.
    constexpr double kRounding = 1e-12;
    const glm::dvec3 low = box.min - kRounding * glm::abs(box.min),
                     high = box.max + kRounding * glm::abs(box.max);
    Ranks::Bytes answer;
    const size_t bytes = io::position_bytes(store_.schema().position);
    uint32_t index = 0;
    LUCARNE_TRY(for_each_record(chunk, [&](const std::byte* record) {
        const glm::dvec3 p = io::position_of(store_.schema(), record);
        const uint32_t i = index++;
        if (!glm::all(glm::greaterThanEqual(p, low)) || !glm::all(glm::lessThanEqual(p, high))) return;
        const auto number = std::as_bytes(std::span(&i, 1));
        answer.insert(answer.end(), number.begin(), number.end());
        answer.insert(answer.end(), record, record + bytes);
    }));
    return answer;
}

}  // namespace lucarne::octree
