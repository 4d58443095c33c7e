#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/formats/common/decimal.h"
#include "io/formats/common/format.h"

namespace lucarne::io {

/// Writes a file that consists of a text header, which states the number of records, and of records of one
/// size. A derived class packs the records.
class CountedWriter : public PointWriter {
 public:
    Result<void> write(std::span<const std::byte> records) final {
        for (; !records.empty(); records = records.subspan(schema_.stride)) {
            const size_t at = buffer_.size();
            buffer_.resize(at + record_bytes_);
            pack(records.data(), buffer_.data() + at);
            ++count_;
            if (buffer_.size() >= kChunkBytes) LUCARNE_TRY(flush());
        }
        return {};
    }
    Result<void> finish() final {
        LUCARNE_TRY(flush());
        const std::string count = std::to_string(count_);
        for (const uint64_t offset : count_offsets_)
            LUCARNE_TRY(file_.write_at(offset, std::as_bytes(std::span(count))));
        return file_.commit();
    }

 protected:
    CountedWriter(OutputFile file, const Schema& schema) : schema_(schema), file_(std::move(file)) {
        for (int axis = 0; axis < 3; ++axis)
            decimals_[static_cast<size_t>(axis)] = text::Decimal::of(schema.scale[axis], schema.offset[axis]);
    }

    /// Packs one record of the schema into one record of the file.
    virtual void pack(const std::byte* record, std::byte* out) const = 0;

    /// Returns a scaled coordinate. If scale and offset are decimal fractions, returns the double nearest to
    /// the exact decimal: 35 * .01 gives .35 and not .35000000000000003.
    double scaled_coordinate(int axis, const std::byte* record) const {
        const auto integer = load<int32_t>(record + 4 * axis);
        const auto& decimal = decimals_[static_cast<size_t>(axis)];
        return decimal ? decimal->value(integer) : integer * schema_.scale[axis] + schema_.offset[axis];
    }

    /// Leaves room for the count at the end of an unfinished header. finish() fills it in.
    void leave_room_for_count(std::string& header) {
        constexpr int kDigits = 20;  // of the largest 64-bit count
        count_offsets_.push_back(header.size());
        header.append(kDigits, ' ');
    }
    Result<void> begin(const std::string& header, size_t record_bytes) {
        record_bytes_ = record_bytes;
        return file_.append(header);
    }

    const Schema schema_;

 private:
    static constexpr size_t kChunkBytes = size_t{2} << 20;

    Result<void> flush() {
        LUCARNE_TRY(file_.append(buffer_));
        buffer_.clear();
        return {};
    }

    OutputFile file_;
    std::array<std::optional<text::Decimal>, 3> decimals_;
    size_t record_bytes_ = 0;
    uint64_t count_ = 0;
    std::vector<uint64_t> count_offsets_;
    std::vector<std::byte> buffer_;
};

}  // namespace lucarne::io
