#include "octree/growing/sample.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include <glm/common.hpp>

#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::octree {
namespace {

constexpr size_t kPiece = 4096;  ///< points that one task picks
constexpr uint64_t kLeastOfInput = 64;

/// Returns the index of the point of run number `rank`. It is at a random position in the run: equal steps
/// would sample a scanner's lines in stripes.
uint64_t index_of(uint64_t rank, uint64_t count, uint64_t wanted) {
    const auto bound = [&](uint64_t i) {
        return static_cast<uint64_t>(static_cast<unsigned __int128>(i) * count / wanted);
    };
    const uint64_t first = bound(rank), run = std::max<uint64_t>(1, bound(rank + 1) - first);
    return first + mix64(rank) % run;
}

/// Counts the points read from all inputs.
class Steps {
 public:
    Steps(const Sampling& told, uint64_t total) : told_(told), total_(total) {}
    Result<void> add(uint64_t points) {
        if (!told_ || told_(done_ += points, total_)) return {};
        return failed("the sample", "was stopped");
    }

 private:
    const Sampling& told_;
    uint64_t total_;
    std::atomic<uint64_t> done_{0};
};

Result<std::vector<std::byte>> pick(const Unifier& inputs, size_t input, uint64_t wanted, Steps& steps) {
    const io::PointSource& source = inputs.source(input);
    const uint64_t count = source.info().declared_points;
    wanted = std::min(wanted, count);
    const size_t pieces = (wanted + kPiece - 1) / kPiece;
    std::vector<std::vector<std::byte>> picked(pieces);
    FirstError error;
    parallel_ranges(wanted, kPiece, [&](size_t first, size_t last) {
        std::vector<uint64_t> indices;
        for (uint64_t rank = first; rank < last; ++rank) indices.push_back(index_of(rank, count, wanted));
        io::PointBatch batch;
        std::vector<std::byte> storage;
        if (auto done = source.pick(indices, batch); !done)
            return error.report(first, std::move(done).error());
        if (auto on = steps.add((last - first) * count / wanted); !on)
            return error.report(first, std::move(on).error());
        const auto records = inputs.convert(input, batch, storage);
        picked[first / kPiece].assign(records.begin(), records.end());
    });
    LUCARNE_TRY(error.result());
    std::vector<std::byte> all;
    for (const auto& piece : picked) all.insert(all.end(), piece.begin(), piece.end());
    return all;
}

/// Keeps every 2^k-th point of one pass. k starts at 0 and grows, because a file's length is known only at
/// its end.
Result<std::vector<std::byte>> read_through(const Unifier& inputs, size_t input, uint64_t wanted,
                                            Steps& steps) {
    LUCARNE_ASSIGN(const auto reader, inputs.source(input).open());
    const size_t stride = inputs.schema().stride;
    std::vector<std::byte> kept, storage;
    io::PointBatch batch;
    uint64_t step = 1, seen = 0;
    for (;;) {
        LUCARNE_ASSIGN(const size_t count, reader->read(batch, size_t{1} << 16));
        if (count == 0) return kept;
        LUCARNE_TRY(steps.add(count));
        const auto records = inputs.convert(input, batch, storage);
        for (size_t i = 0; i < count; ++i, ++seen) {
            if (seen % step != 0) continue;
            kept.insert(kept.end(), &records[i * stride], &records[i * stride] + stride);
            if (kept.size() / stride < 2 * wanted) continue;
            for (size_t half = 0; 2 * half * stride < kept.size(); ++half)
                std::copy_n(&kept[2 * half * stride], stride, &kept[half * stride]);
            kept.resize((kept.size() / stride + 1) / 2 * stride);
            step *= 2;
        }
    }
}

}  // namespace

Result<QuickSample> take_sample(const Unifier& inputs, uint64_t most, const Sampling& sampling) {
    QuickSample sample;
    for (size_t i = 0; i < inputs.inputs(); ++i) sample.points += inputs.source(i).info().declared_points;
    Steps steps(sampling, sample.points);
    for (size_t i = 0; i < inputs.inputs(); ++i) {
        const double share = static_cast<double>(inputs.source(i).info().declared_points) /
                             static_cast<double>(std::max<uint64_t>(1, sample.points));
        const auto wanted = std::max(kLeastOfInput, static_cast<uint64_t>(share * static_cast<double>(most)));
        LUCARNE_ASSIGN(const auto records, inputs.source(i).seekable()
                                               ? pick(inputs, i, wanted, steps)
                                               : read_through(inputs, i, wanted, steps));
        sample.records.insert(sample.records.end(), records.begin(), records.end());
    }
    const size_t stride = inputs.schema().stride, count = sample.records.size() / stride;
    if (count == 0) return rejected(inputs.source(0).info().path, "has no points");
    sample.positions.resize(count);
    sample.min = glm::dvec3(std::numeric_limits<double>::infinity());
    sample.max = -sample.min;
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 p = io::position_of(inputs.schema(), &sample.records[i * stride]);
        sample.positions[i] = p;
        sample.min = glm::min(sample.min, p);
        sample.max = glm::max(sample.max, p);
    }
    return sample;
}

}  // namespace lucarne::octree
