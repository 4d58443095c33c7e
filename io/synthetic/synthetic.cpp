#include "io/synthetic/synthetic.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "io/core/parallel.h"
#include "io/core/random.h"
#include "io/synthetic/generator.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

constexpr uint32_t kMostStations = 1000;
constexpr uint64_t kMostPoints = 1ull << 40;
constexpr double kClearance = .4;     ///< metres around a station
constexpr size_t kPiecesAtOnce = 32;  ///< generated in parallel and then returned; bounds the memory

/// Returns the pieces in order; some are generated ahead, in parallel.
class SyntheticReader final : public PointReader {
 public:
    SyntheticReader(std::shared_ptr<const PieceGenerator> generator, size_t stride)
        : generator_(std::move(generator)), stride_(stride) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        batch.bytes.clear();
        batch.count = 0;
        while (batch.count < most) {
            if (piece_ == ready_.size()) {
                if (next_ == generator_->pieces()) break;
                make_ready();
                continue;
            }
            const auto& piece = ready_[piece_];
            const size_t take = std::min(most - batch.count, (piece.size() - offset_) / stride_);
            const auto from = piece.begin() + static_cast<std::ptrdiff_t>(offset_);
            batch.bytes.insert(batch.bytes.end(), from, from + static_cast<std::ptrdiff_t>(take * stride_));
            batch.count += take;
            offset_ += take * stride_;
            if (offset_ == piece.size()) ++piece_, offset_ = 0;
        }
        return batch.count;
    }
    uint64_t dropped() const override { return 0; }

 private:
    void make_ready() {
        ready_.resize(static_cast<size_t>(std::min<uint64_t>(kPiecesAtOnce, generator_->pieces() - next_)));
        parallel_ranges(ready_.size(), 1, [&](size_t first, size_t) {
            ready_[first].clear();
            generator_->generate(next_ + first, ready_[first]);
        });
        next_ += ready_.size();
        piece_ = offset_ = 0;
    }

    std::shared_ptr<const PieceGenerator> generator_;
    size_t stride_;
    std::vector<std::vector<std::byte>> ready_;
    uint64_t next_ = 0;              ///< the first piece that is not generated yet
    size_t piece_ = 0, offset_ = 0;  ///< next to return: byte `offset_` of ready_[piece_]
};

class SyntheticSource final : public PointSource {
 public:
    SyntheticSource(Schema schema, ScanInfo info, std::shared_ptr<const PieceGenerator> generator)
        : schema_(std::move(schema)), info_(std::move(info)), generator_(std::move(generator)) {}
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        return std::make_unique<SyntheticReader>(generator_, schema_.stride);
    }

 private:
    Schema schema_;
    ScanInfo info_;
    std::shared_ptr<const PieceGenerator> generator_;
};

/// Returns the radical inverse (Halton 1960).
double radical_inverse(uint64_t index, uint64_t base) {
    double value = 0, digit = 1;
    for (; index > 0; index /= base) {
        digit /= static_cast<double>(base);
        value += digit * static_cast<double>(index % base);
    }
    return value;
}

/// Returns the scene's own stations, then Halton points of its walkable box that have enough space around
/// them.
std::vector<dvec3> choose_stations(const SceneGeometry& geometry, uint32_t wanted) {
    const SceneModel& model = geometry.model();
    auto stations = model.stations;
    if (wanted == 0) return stations;
    if (wanted < stations.size()) stations.resize(wanted);
    for (uint64_t i = 1; stations.size() < wanted && i < 100'000; ++i) {
        const dvec3 place =
            glm::mix(model.walk_min, model.walk_max,
                     dvec3(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5)));
        if (!geometry.closest(place, kClearance)) stations.push_back(place);
    }
    return stations;
}

Result<void> check(const SyntheticOptions& options) {
    if (options.points == 0 || options.points > kMostPoints)
        return bad_arguments("--points", fmt::format("{} is out of range", options.points), "give 1 to 2^40");
    if (options.stations > kMostStations)
        return bad_arguments("--stations", fmt::format("{} is too many", options.stations),
                             fmt::format("give at most {}", kMostStations));
    if (!(options.noise >= 0 && options.noise <= 1))
        return bad_arguments("--noise", fmt::format("{} m is out of range", options.noise),
                             "give 0 to 1 metres");
    if (options.even && options.stations > 0)
        return bad_arguments("--stations", "even sampling has no stations", "leave out --even or --stations");
    return {};
}

Result<std::unique_ptr<PointSource>> survey_source(const SyntheticOptions& options) {
    if (options.even || options.normals || options.stations > 0)
        return bad_arguments(options.scene, "has no surface, normals or stations to give",
                             "leave out --even, --normals and --stations");
    ScanInfo info;
    info.path = options.scene;
    info.format = "virtual survey";
    info.declared_points = options.points;
    return std::make_unique<SyntheticSource>(survey_schema(), std::move(info), make_survey(options));
}

}  // namespace

const SyntheticScene& synthetic_survey() {
    static const SyntheticScene kScene{"survey",
                                       "a town from a car's roof, for benchmarks: trees, noise, wild ranges"};
    return kScene;
}

RecordPacker::RecordPacker(bool with_station, bool with_normal)
    : with_station_(with_station), with_normal_(with_normal) {
    schema_.position = PositionType::i32_scaled;
    schema_.scale = dvec3(kScale);
    schema_.add(std::string(names::intensity), ScalarType::u16);
    schema_.add(std::string(names::color), ScalarType::u8, 3);
    if (with_station_) schema_.add(std::string(names::point_source_id), ScalarType::u16);
    if (with_normal_) schema_.add(std::string(names::normal), ScalarType::f32, 3);
}

void RecordPacker::append(const Point& point, std::vector<std::byte>& records) const {
    const size_t begin = records.size();
    records.resize(begin + schema_.stride);
    std::byte* at = records.data() + begin;
    const auto put = [&](auto value) {
        store(at, value);
        at += sizeof value;
    };
    for (int axis = 0; axis < 3; ++axis)
        put(static_cast<int32_t>(std::llround(point.position[axis] / kScale)));
    put(static_cast<uint16_t>(std::lround(65535 * std::clamp(point.signal, 0.0, 1.0))));
    for (int channel = 0; channel < 3; ++channel) put(srgb_code(point.albedo[channel]));
    if (with_station_) put(point.station);
    if (with_normal_)
        for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(point.normal[axis]));
}

Result<std::unique_ptr<PointSource>> synthetic_source(const SyntheticOptions& options) {
    LUCARNE_TRY(check(options));
    if (options.scene == synthetic_survey().name) return survey_source(options);
    LUCARNE_ASSIGN(const std::shared_ptr<const SceneGeometry> geometry, SceneGeometry::create(options.scene));
    const RecordPacker packer(!options.even, options.normals);
    ScanInfo info;
    info.path = options.scene;
    info.format = options.even ? "virtual scan, sampled evenly" : "virtual scan";
    info.declared_points = options.points;
    std::shared_ptr<const PieceGenerator> generator;
    if (options.even) {
        generator = make_even_sampler(geometry, packer, options.points, options.seed);
    } else {
        const ScanSetup setup{choose_stations(*geometry, options.stations), options.points, options.noise,
                              options.seed};
        for (const dvec3& position : setup.stations)
            info.stations.push_back({static_cast<uint32_t>(info.stations.size() + 1), position});
        generator = make_scanner(geometry, packer, setup);
    }
    return std::make_unique<SyntheticSource>(packer.schema(), std::move(info), std::move(generator));
}

}  // namespace lucarne::io
