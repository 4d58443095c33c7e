#include "io/formats/turned.h"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/common.hpp>

namespace lucarne::io {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"x", "y", "z", "-x", "-y", "-z"};

/// A turn by right angles: axis i of the result is axis `from[i]` of the file, times `sign[i]`.
struct Turn {
    std::array<uint8_t, 3> from;
    std::array<int8_t, 3> sign;
};

/// In the order of UpAxis. Each keeps the handedness.
constexpr std::array<Turn, 6> kTurns = {{{{1, 2, 0}, {1, 1, 1}},
                                         {{0, 2, 1}, {1, -1, 1}},
                                         {{0, 1, 2}, {1, 1, 1}},
                                         {{2, 1, 0}, {1, 1, -1}},
                                         {{0, 2, 1}, {1, 1, -1}},
                                         {{0, 1, 2}, {1, -1, -1}}}};

glm::dvec3 turn(const Turn& by, const glm::dvec3& v) {
    return {by.sign[0] * v[by.from[0]], by.sign[1] * v[by.from[1]], by.sign[2] * v[by.from[2]]};
}

/// Returns -value; 0, never -0, for 0. The least integer has no counterpart and becomes the largest, one step
/// away.
template <class T>
T negative(T value) {
    if constexpr (std::is_integral_v<T>)
        if (value == std::numeric_limits<T>::min()) return std::numeric_limits<T>::max();
    return T{0} - value;
}

/// Turns three numbers in place.
template <class T>
void turn_at(const Turn& by, std::byte* at) {
    std::array<T, 3> old, now;
    std::memcpy(old.data(), at, sizeof old);
    for (size_t i = 0; i < 3; ++i) {
        const T value = old[by.from[i]];
        now[i] = by.sign[i] > 0 ? value : negative(value);
    }
    std::memcpy(at, now.data(), sizeof now);
}

/// What of a record has a direction.
class Record {
 public:
    Record(const Schema& schema, const Turn& by) : schema_(schema), by_(by) {
        for (const Attribute& attribute : schema.attributes)
            if ((attribute.name == names::normal || attribute.name == names::splat_axis) &&
                attribute.components == 3 &&
                (attribute.type == ScalarType::f32 || attribute.type == ScalarType::f64))
                directions_.push_back(attribute);
    }
    void turn(PointBatch& batch) const {
        for (size_t i = 0; i < batch.count; ++i) {
            std::byte* const record = &batch.bytes[i * schema_.stride];
            if (schema_.position == PositionType::i32_scaled) turn_at<int32_t>(by_, record);
            if (schema_.position == PositionType::f32) turn_at<float>(by_, record);
            if (schema_.position == PositionType::f64) turn_at<double>(by_, record);
            for (const Attribute& direction : directions_) {
                if (direction.type == ScalarType::f32)
                    turn_at<float>(by_, record + direction.offset);
                else
                    turn_at<double>(by_, record + direction.offset);
            }
        }
    }

 private:
    const Schema& schema_;
    Turn by_;
    std::vector<Attribute> directions_;
};

class TurnedReader final : public PointReader {
 public:
    TurnedReader(std::unique_ptr<PointReader> reader, const Record& record)
        : reader_(std::move(reader)), record_(record) {}
    Result<size_t> read(PointBatch& batch, size_t most) override {
        auto got = reader_->read(batch, most);
        if (got) record_.turn(batch);
        return got;
    }
    uint64_t dropped() const override { return reader_->dropped(); }
    Losses losses() const override { return reader_->losses(); }

 private:
    std::unique_ptr<PointReader> reader_;
    const Record& record_;
};

class TurnedSource final : public PointSource {
 public:
    TurnedSource(std::unique_ptr<PointSource> scan, const Turn& by)
        : scan_(std::move(scan)), schema_(scan_->schema()), record_(schema_, by), info_(scan_->info()) {
        const glm::dvec3 scale = schema_.scale;
        for (int i = 0; i < 3; ++i) schema_.scale[i] = scale[by.from[static_cast<size_t>(i)]];
        schema_.offset = turn(by, schema_.offset);
        for (Station& station : info_.stations) station.position = turn(by, station.position);
        if (info_.stated_box) {
            const glm::dvec3 a = turn(by, (*info_.stated_box)[0]), b = turn(by, (*info_.stated_box)[1]);
            info_.stated_box = {glm::min(a, b), glm::max(a, b)};
        }
    }
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        LUCARNE_ASSIGN(auto reader, scan_->open());
        return std::make_unique<TurnedReader>(std::move(reader), record_);
    }
    bool seekable() const override { return scan_->seekable(); }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        LUCARNE_TRY(scan_->pick(indices, batch));
        record_.turn(batch);
        return {};
    }
    size_t parts() const override { return scan_->parts(); }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        LUCARNE_TRY(scan_->front(part, most, batch));
        record_.turn(batch);
        return {};
    }

 private:
    std::unique_ptr<PointSource> scan_;
    Schema schema_;
    Record record_;
    ScanInfo info_;
};

}  // namespace

std::optional<UpAxis> up_axis(std::string_view name) {
    const auto at = std::ranges::find(kNames, name);
    if (at == kNames.end()) return std::nullopt;
    return static_cast<UpAxis>(at - kNames.begin());
}

std::string_view up_axis_name(UpAxis up) {
    return kNames[static_cast<size_t>(up)];
}

std::unique_ptr<PointSource> turned(std::unique_ptr<PointSource> scan, UpAxis up) {
    if (up == UpAxis::z) return scan;
    return std::make_unique<TurnedSource>(std::move(scan), kTurns[static_cast<size_t>(up)]);
}

}  // namespace lucarne::io
