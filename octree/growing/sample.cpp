#include "octree/growing/sample.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <string_view>
#include <unordered_set>

#include <glm/common.hpp>

#include "io/core/log.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::octree {
namespace {

constexpr size_t kPiece = 4096;  ///< points that one task picks
constexpr uint64_t kLeastOfInput = 64;
constexpr uint64_t kMostFrontBytes = uint64_t{32} << 20;
constexpr uint64_t kLeastOfFront = 1024;  ///< points; opening a part costs as much as reading some hundred

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

/// The front of one part of an input.
struct Front {
    size_t input = 0, part = 0;
    uint64_t read = 0, keep = 0;  ///< points
};

/// Returns the fronts of parts that are spread evenly over the input.
std::vector<Front> fronts_of(const Unifier& inputs, size_t input, uint64_t wanted, uint64_t read) {
    const size_t parts = inputs.source(input).parts();
    const size_t used =
        static_cast<size_t>(std::clamp<uint64_t>(read / kLeastOfFront, 1, std::max<size_t>(1, parts)));
    std::vector<Front> fronts;
    for (size_t i = 0; i < used; ++i)
        fronts.push_back({input, static_cast<size_t>(static_cast<unsigned __int128>(i) * parts / used),
                          std::max<uint64_t>(1, read / used), std::max<uint64_t>(1, wanted / used)});
    return fronts;
}

/// Keeps every k-th point of a front.
Result<std::vector<std::byte>> read_front(const Unifier& inputs, const Front& front, Steps& steps) {
    io::PointBatch batch;
    std::vector<std::byte> storage, kept;
    const io::PointSource& source = inputs.source(front.input);
    const uint64_t most = std::max<uint64_t>(1, kMostFrontBytes / source.schema().stride);
    LUCARNE_TRY(source.front(front.part, static_cast<size_t>(std::min(front.read, most)), batch));
    LUCARNE_TRY(steps.add(batch.count));
    const auto records = inputs.convert(front.input, batch, storage);
    const size_t stride = inputs.schema().stride;
    const size_t step = std::max<size_t>(1, batch.count / static_cast<size_t>(front.keep));
    for (size_t i = 0; i < batch.count; i += step)
        kept.insert(kept.end(), &records[i * stride], &records[i * stride] + stride);
    return kept;
}

/// The part of `most` that an input gets.
uint64_t share_of(const Unifier& inputs, size_t input, uint64_t all, uint64_t most) {
    const double share = static_cast<double>(inputs.source(input).info().declared_points) /
                         static_cast<double>(std::max<uint64_t>(1, all));
    return std::max(kLeastOfInput, static_cast<uint64_t>(share * static_cast<double>(most)));
}

}  // namespace

Result<QuickSample> with_positions(const Unifier& inputs, QuickSample sample) {
    const size_t stride = inputs.schema().stride, count = sample.records.size() / stride;
    if (count == 0) return rejected(inputs.source(0).info().path, "has no points");
    sample.positions.resize(count);
    sample.min = glm::dvec3(std::numeric_limits<double>::infinity());
    sample.max = -sample.min;
    parallel_ranges(count, kPiece, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            sample.positions[i] = io::position_of(inputs.schema(), &sample.records[i * stride]);
    });
    for (const glm::dvec3& p : sample.positions) {
        sample.min = glm::min(sample.min, p);
        sample.max = glm::max(sample.max, p);
    }
    return sample;
}

Result<QuickSample> join(const Unifier& inputs, const QuickSample& sample, std::vector<std::byte> records) {
    const size_t stride = inputs.schema().stride;
    const auto text_of = [&](const std::vector<std::byte>& all, size_t at) {
        return std::string_view(reinterpret_cast<const char*>(&all[at]), stride);
    };
    std::unordered_set<std::string_view> known;
    for (size_t at = 0; at < sample.records.size(); at += stride) known.insert(text_of(sample.records, at));
    QuickSample both;
    both.points = sample.points;
    both.has_gaps = sample.has_gaps;
    both.records = sample.records;
    for (size_t at = 0; at < records.size(); at += stride)
        if (!known.contains(text_of(records, at)))
            both.records.insert(both.records.end(), &records[at], &records[at] + stride);
    return with_positions(inputs, std::move(both));
}

Result<QuickSample> take_sample(const Unifier& inputs, uint64_t most, const Sampling& sampling) {
    QuickSample sample;
    sample.points = inputs.declared_points();
    Steps steps(sampling, sample.points);
    for (size_t i = 0; i < inputs.inputs(); ++i) {
        const uint64_t wanted = share_of(inputs, i, sample.points, most);
        LUCARNE_ASSIGN(const auto records, inputs.source(i).seekable()
                                               ? pick(inputs, i, wanted, steps)
                                               : read_through(inputs, i, wanted, steps));
        sample.records.insert(sample.records.end(), records.begin(), records.end());
    }
    return with_positions(inputs, std::move(sample));
}

Result<QuickSample> take_sketch(const Unifier& inputs, uint64_t most, uint64_t read,
                                const Sampling& sampling) {
    QuickSample sample;
    sample.points = inputs.declared_points();
    if (inputs.inputs() == 1 && (sample.points <= read || inputs.source(0).seekable()))
        return take_sample(inputs, most, sampling);
    Steps steps(sampling, std::min(read, sample.points));
    std::vector<Front> fronts;  // one for each seekable input
    for (size_t i = 0; i < inputs.inputs(); ++i) {
        const uint64_t wanted = share_of(inputs, i, sample.points, most);
        if (inputs.source(i).seekable()) {
            fronts.push_back({i, 0, 0, wanted});
            continue;
        }
        const auto more = fronts_of(inputs, i, wanted, share_of(inputs, i, sample.points, read));
        sample.has_gaps = true;
        fronts.insert(fronts.end(), more.begin(), more.end());
    }
    std::vector<Result<std::vector<std::byte>>> taken(fronts.size());
    parallel_ranges(fronts.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            taken[i] = fronts[i].read ? read_front(inputs, fronts[i], steps)
                                      : pick(inputs, fronts[i].input, fronts[i].keep, steps);
    });
    std::vector<Error> broken;
    for (auto& records : taken) {
        if (records)
            sample.records.insert(sample.records.end(), records->begin(), records->end());
        else if (records.error().kind == ErrorKind::input_rejected)
            broken.push_back(std::move(records).error());
        else
            return tl::unexpected(std::move(records).error());
    }
    if (!broken.empty() && (inputs.inputs() == 1 || sample.records.empty()))
        return tl::unexpected(std::move(broken.front()));
    for (const Error& error : broken) log::warn("{}; skipped in the first pictures", error.line());
    return with_positions(inputs, std::move(sample));
}

}  // namespace lucarne::octree
