#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/points.h"
#include "octree/tree/source.h"
#include "tests/io/io_testing.h"

namespace lucarne::test {

/// A scan whose i-th record is computed. Only one batch is in memory, so the scan can be of any size.
class ComputedSource final : public io::PointSource {
 public:
    using Fill = std::function<void(uint64_t index, std::byte* record)>;
    ComputedSource(io::Schema schema, uint64_t points, Fill fill)
        : schema_(std::move(schema)), points_(points), fill_(std::move(fill)) {
        info_.path = "computed";
        info_.format = "test";
        info_.declared_points = points;
    }

    const io::Schema& schema() const override { return schema_; }
    const io::ScanInfo& info() const override { return info_; }
    io::ScanInfo& info() { return info_; }
    uint64_t points() const { return points_; }
    Result<std::unique_ptr<io::PointReader>> open() const override { return std::make_unique<Reader>(*this); }
    /// No batch has more points than this, whatever is requested.
    void limit_batches(size_t most) { most_ = most; }
    void make_seekable() { seekable_ = true; }
    bool seekable() const override { return seekable_; }
    Result<void> pick(std::span<const uint64_t> indices, io::PointBatch& batch) const override {
        batch.count = indices.size();
        batch.bytes.assign(batch.count * schema_.stride, std::byte{0});
        for (size_t i = 0; i < indices.size(); ++i) fill_(indices[i], &batch.bytes[i * schema_.stride]);
        return {};
    }

 private:
    class Reader final : public io::PointReader {
     public:
        explicit Reader(const ComputedSource& source) : source_(source) {}
        Result<size_t> read(io::PointBatch& batch, size_t most) override {
            batch.count = static_cast<size_t>(
                std::min<uint64_t>(std::min(most, source_.most_), source_.points_ - next_));
            batch.bytes.assign(batch.count * source_.schema_.stride, std::byte{0});
            for (size_t i = 0; i < batch.count; ++i)
                source_.fill_(next_++, &batch.bytes[i * source_.schema_.stride]);
            return batch.count;
        }
        uint64_t dropped() const override { return 0; }

     private:
        const ComputedSource& source_;
        uint64_t next_ = 0;
    };

    io::Schema schema_;
    io::ScanInfo info_;
    uint64_t points_;
    size_t most_ = SIZE_MAX;
    bool seekable_ = false;
    Fill fill_;
};

using TempFolder = io::testing::TemporaryFolder;

/// Returns the first `bytes` of every record, sorted: equal for equal multisets.
inline std::vector<std::string> sorted_records(const io::PointSource& source, size_t bytes) {
    std::vector<std::string> all;
    auto reader = source.open();
    io::PointBatch batch;
    while (reader && (*reader)->read(batch, 10'000).value_or(0) > 0)
        for (size_t i = 0; i < batch.count; ++i)
            all.emplace_back(reinterpret_cast<const char*>(&batch.bytes[i * source.schema().stride]), bytes);
    std::sort(all.begin(), all.end());
    return all;
}
inline std::vector<std::string> sorted_records(const octree::NodeSource& source, size_t bytes) {
    std::vector<std::string> all;
    const uint32_t stride = source.header().schema.stride;
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const auto data = source.load(node);
        for (size_t i = 0; data && i < data->count; ++i)
            all.emplace_back(reinterpret_cast<const char*>(&data->records[i * stride]), bytes);
    }
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace lucarne::test
