#include "octree/holes/hole_survey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <glm/common.hpp>

#include "octree/cache/format.h"
#include "octree/cache/writer.h"
#include "octree/codec/payload.h"
#include "octree/holes/holes.h"
#include "octree/stations/lone_station.h"
#include "octree/tree/attributes.h"
#include "octree/tree/filling.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/prefix_order.h"
#include "octree/tree/radix_sort.h"
#include "octree/tree/station_ids.h"

namespace lucarne::octree {
namespace {

/// Points of the sample: a quarter of all within these limits. Memory for one, all in all.
constexpr uint64_t kLeastSample = 1 << 17, kMostSample = 1 << 19, kSampleShare = 4, kSampleBytes = 256;
constexpr uint64_t kPointsOfSurfel = 16;
constexpr float kStrayShare =
    1e-20f;  ///< in faces of the root cube: outliers are stored as the smallest area

double linear_of_srgb(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double srgb_of_linear(double v) {
    return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// Reads the linear colours of points as they are drawn: with the gains of their stations.
class DrawnColours {
 public:
    explicit DrawnColours(const SourceHeader& header) : header_(header), keys_(header.schema) {
        const auto* color = header.schema.find(io::names::color);
        if (color && color->components == 3) color_ = color;
        for (size_t i = 0; i < linear_.size(); ++i)
            linear_[i] = static_cast<float>(linear_of_srgb(static_cast<double>(i) / kSteps));
    }
    glm::vec3 of(const std::byte* record) {
        if (!color_) return glm::vec3(0.5f);
        if (const StationKey key = keys_.of(record); !last_ || *last_ != key) {
            last_ = key;
            white_ =
                io::color_white(key.scan < header_.scans.size() ? header_.scans[key.scan].color_bits : 8);
            entry_ = find_colour(header_.station_colours, key);
        }
        const size_t step = io::scalar_bytes(color_->type);
        glm::vec3 colour;
        bool black = true;
        for (int c = 0; c < 3; ++c) {
            const double share =
                io::scalar_at(color_->type, record + color_->offset + static_cast<size_t>(c) * step) / white_;
            black &= share == 0;
            const double at = share > 0 ? std::min(share, 1.0) : 0.0;
            colour[c] = linear_[static_cast<size_t>(at * kSteps + 0.5)];
        }
        if (!entry_) return colour;
        if (black && entry_->unphotographed) colour = glm::vec3(*entry_->unphotographed);
        return glm::min(colour * glm::vec3(entry_->gain), glm::vec3(1.0f));
    }

 private:
    const SourceHeader& header_;
    const StationKeys keys_;
    const io::Attribute* color_ = nullptr;
    std::optional<StationKey> last_;  ///< the last point's station, and what follows from it
    double white_ = 255;
    const StationColour* entry_ = nullptr;
    static constexpr double kSteps = 1023;
    std::array<float, 1024> linear_{};
};

/// Collects the sample in metres relative to the root cube's corner.
class SampleReader {
 public:
    explicit SampleReader(const SourceHeader& header)
        : header_(header),
          normals_(header.schema),
          colours_(header),
          ids_(header.scans, header.schema, header.estimated_stations),
          area_(header.schema.find(io::names::area)),
          unit_(header.metres_per_unit) {
        for (const glm::dvec3& station : ids_.stations())
            sample_.stations.emplace_back(unit_ * (station - header.root.min));
    }

    void add(const NodeData& data, float floor) {
        const double edge = header_.root.first_size();
        for (uint32_t i = 0; i < data.count; ++i) {
            const std::byte* record = &data.records[i * header_.schema.stride];
            const glm::vec3 normal = normals_.of(record);
            const double area = decode_area(io::load<uint16_t>(record + area_->offset), edge);
            if (normal == glm::vec3(0.0f) || !(area > kStrayShare * edge * edge)) continue;
            sample_.points.push_back(
                {.position = glm::vec3(unit_ * (io::position_of(header_.schema, record) - header_.root.min)),
                 .normal = normal,
                 .colour = colours_.of(record),
                 .area = static_cast<float>(unit_ * unit_ * area),
                 .station = ids_.of(record)});
        }
        if (floor > 0) floors_.push_back(static_cast<float>(unit_ * unit_) * floor);
    }

    /// Returns the sample. Where points were left out, each stands for the surface of those around it.
    HoleSample take() {
        if (floors_.empty()) return std::move(sample_);
        const auto middle = floors_.begin() + static_cast<ptrdiff_t>(floors_.size() / 2);
        std::nth_element(floors_.begin(), middle, floors_.end());
        for (HolePoint& point : sample_.points) point.area = std::max(point.area, *middle);
        return std::move(sample_);
    }

 private:
    const SourceHeader& header_;
    const PointNormals normals_;
    DrawnColours colours_;
    const StationIds ids_;
    const io::Attribute* area_;
    const double unit_;
    HoleSample sample_;
    std::vector<float> floors_;
};

/// Returns the surfels' records in the schema of a filling, along the Morton curve.
std::vector<std::byte> records_of(const std::vector<FillPoint>& points, const SourceHeader& header,
                                  const io::Schema& schema) {
    const auto world = [&](const FillPoint& point) {
        return header.root.min + glm::dvec3(point.position) / header.metres_per_unit;
    };
    std::vector<CodeIndex> sorted;
    for (uint32_t i = 0; i < points.size(); ++i)
        sorted.push_back({header.root.place(world(points[i])).code(), i});
    sort_by_code(sorted, 3 * kMaxLevel);
    const size_t color = schema.find(io::names::color)->offset,
                 normal = schema.find(io::names::normal_oct)->offset,
                 area = schema.find(io::names::area)->offset;
    std::vector<std::byte> records(points.size() * schema.stride);
    std::byte* record = records.data();
    for (const CodeIndex& from : sorted) {
        const FillPoint& point = points[from.index];
        const glm::dvec3 steps = (world(point) - schema.offset) / schema.scale;
        for (int c = 0; c < 3; ++c) {
            const auto at = static_cast<size_t>(c);
            io::store(record + 4 * at,
                      static_cast<int32_t>(std::clamp(std::round(steps[c]), -0x1p31, 0x1p31 - 1)));
            const double share = std::clamp(srgb_of_linear(point.colour[c]), 0.0, 1.0);
            io::store(record + color + at, static_cast<uint8_t>(std::lround(255 * share)));
        }
        io::store(record + normal, encode_normal(point.normal));
        const double unit = header.metres_per_unit;
        io::store(record + area, encode_area(point.area / (unit * unit), header.root.first_size()));
        record += schema.stride;
    }
    return records;
}

/// Returns the records in prefix order.
std::vector<std::byte> in_prefix_order(const std::vector<std::byte>& records,
                                       const std::vector<uint8_t>& passes, size_t stride) {
    std::vector<uint32_t> order;
    append_prefix_order(passes, 0, order);
    std::vector<std::byte> ordered;
    ordered.reserve(records.size());
    for (const uint32_t i : order)
        ordered.insert(ordered.end(), records.begin() + static_cast<ptrdiff_t>(i * stride),
                       records.begin() + static_cast<ptrdiff_t>((i + 1) * stride));
    return ordered;
}

/// Returns the station that saw all points from over a round hole of a floor, if there is such a place, and
/// enters it in the sample.
std::optional<glm::vec3> station_over(const glm::vec3& tripod, HoleSample& sample) {
    std::vector<glm::vec3> points;
    points.reserve(sample.points.size());
    for (const HolePoint& point : sample.points) points.push_back(point.position);
    const auto station = find_lone_station(points, tripod);
    if (!station) return station;
    sample.stations = {*station};
    for (HolePoint& point : sample.points) point.station = 0;
    return station;
}

}  // namespace

Result<HoleSurvey> fill_holes(CacheWriter& writer, const SourceHeader& header, uint64_t memory) {
    HoleSurvey survey;
    FillingSection& section = survey.filling;
    const auto* area = header.schema.find(io::names::area);
    const bool normals = header.schema.find(io::names::normal) || header.schema.find(io::names::normal_oct);
    if (!area || area->type != io::ScalarType::u16 || !normals) return survey;
    SampleReader reader(header);
    LUCARNE_TRY(writer.visit_even(
        header,
        std::min(std::clamp(header.points / kSampleShare, kLeastSample, kMostSample), memory / kSampleBytes),
        [&](const Cube&, const NodeData& data, float floor) { reader.add(data, floor); }));
    const HoleLimits limits{.most_points = std::min(kMostFilled, header.points / kPointsOfSurfel),
                            .memory = memory / 4};
    HoleSample sample = reader.take();
    FoundHoles found = find_holes(sample, limits);
    const bool unknown = sample.stations.empty() && header.estimated_stations.empty();
    if (unknown && header.scans.size() == 1 && found.tripods.size() == 1) {
        if (const auto station = station_over(found.tripods.front(), sample)) {
            survey.station = {.scan = 0,
                              .position = header.root.min + glm::dvec3(*station) / header.metres_per_unit,
                              .saw_all = true};
            found = find_holes(sample, limits);
        }
    }
    const std::vector<FillPoint>& points = found.points;
    if (points.empty()) return survey;
    section.schema = filling_schema(header.root);
    const auto records = records_of(points, header, section.schema);
    const std::vector<uint8_t> passes(points.size(), 0);
    std::vector<std::byte> payload;
    codec::PayloadEncoder(section.schema).encode(records, passes, payload);
    section.codec = payload.size() < records.size() ? format::kCodecColumns : format::kCodecRaw;
    if (section.codec == format::kCodecRaw) payload = in_prefix_order(records, passes, section.schema.stride);
    section.points = points.size();
    section.bytes = payload.size();
    section.checksum = format::checksum(payload);
    LUCARNE_ASSIGN(section.offset, writer.append(payload));
    return survey;
}

}  // namespace lucarne::octree
