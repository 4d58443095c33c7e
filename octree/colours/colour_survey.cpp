#include "octree/colours/colour_survey.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "octree/cache/metadata.h"
#include "octree/cache/writer.h"

namespace lucarne::octree {
namespace {

constexpr size_t kMostStations = kMostStationColours;
constexpr size_t kMostRatios = 262144;  // 2.5 MiB
constexpr uint32_t kCells = 16;         // along a node's cube: eight times the spacing of its samples
constexpr uint32_t kLeastPoints = 3;    // of a station in a cell
constexpr double kClipped = 250.0 / 255;
constexpr float kDark = 0.002f;       // linear; darker ratios consist of rounding and noise
constexpr float kCoherent = 0.8f;     // length of the mean normal on one surface
constexpr float kSameNormal = 0.87f;  // cosine of 30 degrees
constexpr uint64_t kFirstLook = 65536, kMostPoints = 1'000'000;

/// sRGB, IEC 61966-2-1.
double linear_of(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

uint32_t cell_of(double offset, double size) {
    const double cell = offset / size * kCells;
    return cell > 0 ? static_cast<uint32_t>(std::min(cell, double{kCells - 1})) : 0u;
}

}  // namespace

ColourSurvey::ColourSurvey(const SourceHeader& header)
    : header_(header), keys_(header.schema), normals_(header.schema) {
    has_normals_ = header.schema.find(io::names::normal) || header.schema.find(io::names::normal_oct);
    const auto* color = header.schema.find(io::names::color);
    if (color && color->components == 3) color_ = color;
    for (size_t i = 0; i < linear_.size(); ++i)
        linear_[i] = static_cast<float>(linear_of(static_cast<double>(i) / 255));
}

/// Returns the index of a station; kMostStations if there are too many.
size_t ColourSurvey::station_of(const StationKey& key) {
    if (const auto found = index_of_.find(key); found != index_of_.end()) return found->second;
    if (stations_.size() == kMostStations || key.scan >= header_.scans.size()) return kMostStations;
    index_of_.emplace(key, stations_.size());
    Station& station = stations_.emplace_back();
    station.key = key;
    station.white = io::color_white(header_.scans[key.scan].color_bits);
    return stations_.size() - 1;
}

void ColourSurvey::add(const Cube& cube, const NodeData& data) {
    if (!color_) return;
    points_ += data.count;
    see(data);
    const bool several =
        std::ranges::any_of(seen_, [&](const Seen& seen) { return seen.station != seen_.front().station; });
    if (several) compare_cells(cube, data);
}

/// Counts the points' colours by station.
void ColourSurvey::see(const NodeData& data) {
    const size_t stride = header_.schema.stride, step = io::scalar_bytes(color_->type);
    seen_.clear();
    std::optional<StationKey> last;
    size_t index = kMostStations;
    for (uint32_t i = 0; i < data.count; ++i) {
        const std::byte* record = &data.records[i * stride];
        if (const StationKey key = keys_.of(record); key != last) {
            index = station_of(key);
            last = key;
        }
        if (index == kMostStations) continue;
        Station& station = stations_[index];
        const std::byte* at = record + color_->offset;
        glm::dvec3 share;
        for (int c = 0; c < 3; ++c, at += step) share[c] = io::scalar_at(color_->type, at) / station.white;
        if (share == glm::dvec3(0.0)) {
            ++station.zeros;
            continue;
        }
        const double most = std::max({share.x, share.y, share.z}),
                     least = std::min({share.x, share.y, share.z});
        if (!(least >= 0 && most <= 1) || std::isnan(share.x + share.y + share.z)) continue;
        Seen seen{i, static_cast<uint32_t>(index), glm::vec3(0.0f), most >= kClipped};
        for (int c = 0; c < 3; ++c)
            seen.colour[c] = station.white == 255 ? linear_[static_cast<size_t>(share[c] * 255 + 0.5)]
                                                  : static_cast<float>(linear_of(share[c]));
        ++station.coloured;
        ++station.brightness[static_cast<size_t>(most * 255 + 0.5)];
        station.sum += glm::dvec3(seen.colour);
        seen_.push_back(seen);
    }
}

/// Sums up what each station saw in each cell of the node, and compares stations in the same cell.
void ColourSurvey::compare_cells(const Cube& cube, const NodeData& data) {
    const size_t stride = header_.schema.stride;
    sorted_.clear();
    for (uint32_t i = 0; i < seen_.size(); ++i) {
        const auto p = io::position_of(header_.schema, &data.records[seen_[i].record * stride]) - cube.min;
        const uint64_t cell =
            (cell_of(p.z, cube.size) * kCells + cell_of(p.y, cube.size)) * kCells + cell_of(p.x, cube.size);
        sorted_.push_back({cell << 10 | seen_[i].station, i});
    }
    static_assert(kMostStations <= 1 << 10);
    sort_by_code(sorted_, 10 + 12);
    static_assert(kCells == 1 << 4);
    for (size_t at = 0; at < sorted_.size();) {
        const uint64_t cell = sorted_[at].code >> 10;
        patches_.clear();
        for (; at < sorted_.size() && sorted_[at].code >> 10 == cell; ++at) {
            const Seen& seen = seen_[sorted_[at].index];
            if (patches_.empty() || patches_.back().station != seen.station)
                patches_.push_back({.station = seen.station});
            Patch& patch = patches_.back();
            const auto normal =
                has_normals_ ? normals_.of(&data.records[seen.record * stride]) : glm::vec3(0.0f);
            if (has_normals_ && normal == glm::vec3(0.0f)) continue;
            ++patch.points;
            patch.colour += seen.colour;
            patch.normal += normal;
            patch.clipped |= seen.clipped;
        }
        if (patches_.size() > 1) compare_patches();
    }
}

/// Compares the stations that saw one cell, where they saw the same surface in it.
void ColourSurvey::compare_patches() {
    std::erase_if(patches_, [&](Patch& patch) {
        if (patch.points < kLeastPoints || patch.clipped) return true;
        patch.colour /= static_cast<float>(patch.points);
        patch.normal /= static_cast<float>(patch.points);
        const float length = glm::length(patch.normal);
        if (has_normals_) {
            if (length < kCoherent) return true;
            patch.normal /= length;
        }
        return std::min({patch.colour.x, patch.colour.y, patch.colour.z}) < kDark;
    });
    for (size_t a = 0; a < patches_.size(); ++a)
        for (size_t b = a + 1; b < patches_.size(); ++b) {
            if (has_normals_ && glm::dot(patches_[a].normal, patches_[b].normal) < kSameNormal) continue;
            // By key, so that the order in which stations were found does not matter.
            const bool swap = stations_[patches_[b].station].key < stations_[patches_[a].station].key;
            const Patch &low = patches_[swap ? b : a], &high = patches_[swap ? a : b];
            PatchRatio ratio{static_cast<uint16_t>(low.station), static_cast<uint16_t>(high.station), {}};
            for (int c = 0; c < 3; ++c)  // at most 9 stops, as patches are neither dark nor clipped
                ratio.ratio[static_cast<size_t>(c)] = static_cast<int16_t>(
                    std::lround(kLogSteps * std::log2(static_cast<double>(low.colour[c] / high.colour[c]))));
            keep(ratio);
        }
}

/// Keeps every step_-th ratio; halves what is kept when there are too many.
void ColourSurvey::keep(const PatchRatio& ratio) {
    if (offered_++ % step_ != 0) return;
    ratios_.push_back(ratio);
    if (ratios_.size() < kMostRatios) return;
    for (size_t i = 0; i < ratios_.size() / 2; ++i) ratios_[i] = ratios_[2 * i];
    ratios_.resize(ratios_.size() / 2);
    step_ *= 2;
}

/// Whether the colour 0,0,0 of a station's points means that no camera saw them. Photographs of black things
/// become rarer towards 0 gradually, or pile up there; points without a photograph are apart: far more of
/// them than of the next darker colours, which are rare themselves. Drawings, whose colours are few, may use
/// black.
bool ColourSurvey::never_photographed(const Station& station) {
    constexpr uint64_t kLeastZeros = 32;
    constexpr size_t kDarkLevels = 8, kLeastLevels = 48;
    if (station.zeros < kLeastZeros) return false;
    uint64_t dark = 0, levels = 0;
    for (size_t i = 0; i < station.brightness.size(); ++i) {
        if (i <= kDarkLevels) dark += station.brightness[i];
        levels += station.brightness[i] > 0;
    }
    const double share = static_cast<double>(kDarkLevels) / 255;  // of the range
    return levels >= kLeastLevels && station.zeros > 8 * (dark + 1) &&
           static_cast<double>(dark) < 0.5 * share * static_cast<double>(station.coloured);
}

std::vector<StationColour> ColourSurvey::result() const {
    const auto gains = solve_gains(ratios_, stations_.size());
    std::vector<StationColour> colours;
    for (auto it = index_of_.begin(); it != index_of_.end(); ++it) {
        const Station& station = stations_[it->second];
        const auto same_scan = [&](const auto& other) { return other.first.scan == it->first.scan; };
        StationColour colour{.scan = station.key.scan};
        if (keys_.has_stations() && std::count_if(index_of_.begin(), index_of_.end(), same_scan) > 1)
            colour.station = station.key.station;
        for (int c = 0; c < 3; ++c) {
            const double gain = std::exp2(gains[it->second][static_cast<size_t>(c)]);
            colour.gain[c] = std::clamp(std::round(1e4 * gain) / 1e4, 1 / kMostGain, kMostGain);
        }
        if (never_photographed(station))
            colour.unphotographed =
                glm::round(1e4 * station.sum / static_cast<double>(station.coloured)) / 1e4;
        if (colour.gain != glm::dvec3(1.0) || colour.unphotographed) colours.push_back(colour);
    }
    return colours;
}

Result<std::vector<StationColour>> survey_colours(CacheWriter& writer, const SourceHeader& header) {
    ColourSurvey survey(header);
    if (!survey.has_colours()) return std::vector<StationColour>{};
    const uint64_t most = std::clamp(header.points / 8, kFirstLook, kMostPoints);
    LUCARNE_TRY(writer.visit_coarsest(header, most, [&](const Cube& cube, const NodeData& data) {
        survey.add(cube, data);
        // The colours of a single station are compared with nothing; a first look tells which of them it has.
        return survey.stations() > 1 || survey.points() < kFirstLook;
    }));
    return survey.result();
}

}  // namespace lucarne::octree
