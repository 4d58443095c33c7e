#include "octree/colours/even_colours.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

/// Neighbours are looked for among so many points before and after a point along the Morton curve. On a
/// surface these are nearly all that lie within kReach spacings.
constexpr size_t kWindow = 24;
constexpr float kReach = 2.5f, kNearReach = 1.5f;  ///< of neighbours and of the nearest, spacings
constexpr float kSameSide = 0.8f;                  ///< least cosine between the normals of neighbours
/// The variance among the nearest points over that among all neighbours: 1 and a little more where colours
/// differ at random, as each neighbourhood knows its own mean; below .8 in stripes that are two points wide.
/// Between these values the change fades in. Geostatistics calls this share of the variance the nugget.
constexpr float kTexture = 0.9f, kRandom = 1.05f;
/// Variances of luma (white is 1) between which the change fades in: differences of 2 % are hardly seen.
constexpr float kInvisible = 2e-4f, kVisible = 8e-4f;
/// Photographs that are mixed are so all over a chunk. Where fewer of its points would change, these are
/// corners and lines as thin as the spacing, and stay.
constexpr double kLeastChanged = 0.1;
/// Points are read in blocks. Groups in which successive points differ less than this hold no random colours.
constexpr size_t kBlock = 4096, kGroup = 64;
constexpr float kSmooth = kInvisible / 3;
/// A point's mean is that of its neighbours' means, and these need their neighbours.
constexpr size_t kMargin = 2 * kWindow;
/// A colour up to this may be a blend with points that were never photographed, which are 0,0,0.
constexpr float kBlack = 16.5f / 255;
/// Squared radii, in edges of the root cube, whose reciprocals floats can represent.
constexpr float kLeastRadius2 = 1e-30f;

}  // namespace

ColourEvening::ColourEvening(const io::Schema& schema, std::span<const double> whites, float unit_area)
    : schema_(schema), whites_(whites), unit_area_(unit_area), keys_(schema), normals_(schema) {
    const auto* color = schema.find(io::names::color);
    const auto* change = schema.find(io::names::color_change);
    if (!color || color->components != 3 || !change) return;
    color_ = color;
    change_ = change;
    for (auto* floats : {&x_, &y_, &z_, &normal_x_, &normal_y_, &normal_z_, &luma_, &radius2_, &near_, &all_})
        floats->resize(kBlock + 2 * kMargin);
    station_.resize(kBlock + 2 * kMargin);
    color_of_.resize(kBlock + 2 * kMargin);
    mean_.resize(kBlock + 2 * kMargin);
    neighbour_.resize(2 * kWindow + 1);
}

void ColourEvening::even(std::span<std::byte> records, std::span<const Place> places,
                         std::span<const float> areas) {
    if (!color_) return;
    const size_t points = places.size();
    size_t changed = 0;
    for (size_t begin = 0; begin < points; begin += kBlock) {
        const size_t end = std::min(points, begin + kBlock);
        const size_t first = begin - std::min(begin, kMargin), last = std::min(points, end + kMargin);
        read(records, places, areas, first, last - first);
        find_rough_groups();
        for (size_t i = 0; i < last - first; ++i) compare(i);
        for (size_t i = begin; i < end; ++i) {
            const ColourChange change = change_of(i - first);
            io::store(&records[i * schema_.stride + change_->offset], change);
            changed += change != ColourChange{};
        }
    }
    if (static_cast<double>(changed) >= kLeastChanged * static_cast<double>(points)) return;
    for (size_t i = 0; i < points; ++i)
        io::store(&records[i * schema_.stride + change_->offset], ColourChange{});
}

void ColourEvening::read(std::span<const std::byte> records, std::span<const Place> places,
                         std::span<const float> areas, size_t first, size_t count) {
    const size_t step = io::scalar_bytes(color_->type);
    const Place& base = places[first];
    const auto from = [](uint32_t at, uint32_t origin) {
        return static_cast<float>(std::ldexp(static_cast<double>(at) - static_cast<double>(origin), -32));
    };
    luma_.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const std::byte* record = &records[(first + i) * schema_.stride];
        const Place& place = places[first + i];
        x_[i] = from(place.x, base.x), y_[i] = from(place.y, base.y), z_[i] = from(place.z, base.z);
        const glm::vec3 normal = normals_.of(record);
        normal_x_[i] = normal.x, normal_y_[i] = normal.y, normal_z_[i] = normal.z;
        const StationKey key = keys_.of(record);
        station_[i] = key.scan << 16 | key.station;
        const double white = key.scan < whites_.size() ? whites_[key.scan] : 0;
        glm::vec3& srgb = color_of_[i];
        for (int c = 0; c < 3; ++c)
            srgb[c] = static_cast<float>(
                io::scalar_at(color_->type, record + color_->offset + static_cast<size_t>(c) * step) / white);
        // Points that no camera saw (0,0,0), and blends with such points, take no part.
        const auto shown = [](float value) { return value >= 0 && value <= 1; };
        const bool seen = white > 0 && shown(srgb.x) && shown(srgb.y) && shown(srgb.z) &&
                          std::max({srgb.x, srgb.y, srgb.z}) > kBlack;
        if (!seen) srgb = glm::vec3(0.0f);
        luma_[i] = glm::dot(srgb, glm::vec3(0.299f, 0.587f, 0.114f));
        const float radius2 = kReach * kReach * unit_area_ * areas[first + i];
        radius2_[i] = seen && normal != glm::vec3(0.0f) && radius2 > kLeastRadius2 ? radius2 : 0.0f;
    }
}

void ColourEvening::find_rough_groups() {
    const size_t count = luma_.size();
    rough_.assign(count / kGroup + 1, false);
    for (size_t group = 0; group < rough_.size(); ++group) {
        float sum = 0;
        const size_t end = std::min(count, (group + 1) * kGroup);
        for (size_t i = std::max<size_t>(1, group * kGroup); i < end; ++i) {
            const float difference = luma_[i] - luma_[i - 1];
            sum += difference * difference / 2;
        }
        rough_[group] = sum > kSmooth * kGroup;
    }
}

/// Finds the points around a point and their weights. Returns false if the point takes no part.
bool ColourEvening::weigh(size_t point) {
    if (!(radius2_[point] > 0)) return false;
    const float x = x_[point], y = y_[point], z = z_[point], inverse = 1 / radius2_[point];
    const float nx = normal_x_[point], ny = normal_y_[point], nz = normal_z_[point];
    const uint32_t station = station_[point];
    const size_t first = point - std::min(point, kWindow);
    const size_t count = std::min(luma_.size(), point + kWindow + 1) - first;
    std::array<float, 2 * kWindow + 1> weights;
    for (size_t i = 0; i < count; ++i) {  // no branches, so that the compiler makes vectors of it
        const size_t j = first + i;
        const float dx = x_[j] - x, dy = y_[j] - y, dz = z_[j] - z;
        const float cosine = normal_x_[j] * nx + normal_y_[j] * ny + normal_z_[j] * nz;
        const float weight = 1 - (dx * dx + dy * dy + dz * dz) * inverse;
        const bool counts =
            (cosine > kSameSide) & (weight > 0) & (radius2_[j] > 0) & (station_[j] == station);
        weights[i] = counts ? weight : 0.0f;
    }
    around_ = 0;
    for (size_t i = 0; i < count; ++i) {  // no branches here either: they are hard to predict
        neighbour_[around_] = {static_cast<uint32_t>(first + i), weights[i]};
        around_ += weights[i] > 0;
    }
    return true;
}

/// Finds the mean colour around a point, and how much lumas differ from it and from the nearest ones.
void ColourEvening::compare(size_t point) {
    mean_[point] = color_of_[point];
    near_[point] = all_[point] = 0;
    const size_t group = point / kGroup;
    const bool asked =
        rough_[group] || (group > 0 && rough_[group - 1]) || (group + 1 < rough_.size() && rough_[group + 1]);
    if (!asked || !weigh(point)) return;
    constexpr float kNearWeight = 1 - kNearReach * kNearReach / (kReach * kReach);
    float sum = 0, luma = 0, luma2 = 0, nearest = 0, differences = 0;
    glm::vec3 color(0.0f);
    for (const auto& [j, weight] : std::span(neighbour_).first(around_)) {
        sum += weight;
        luma += weight * luma_[j];
        luma2 += weight * luma_[j] * luma_[j];
        color += weight * color_of_[j];
        const float near = j == point ? 0.0f : std::max(0.0f, weight - kNearWeight);
        const float difference = luma_[j] - luma_[point];
        nearest += near;
        differences += near * difference * difference / 2;
    }
    const float mean = luma / sum;  // the point itself counts, so the sum is at least 1
    mean_[point] = color / sum;
    all_[point] = std::max(0.0f, luma2 / sum - mean * mean);
    near_[point] = nearest > 0 ? differences / nearest : 0.0f;
}

ColourChange ColourEvening::change_of(size_t point) {
    constexpr ColourChange kNone{};
    if (!rough_[point / kGroup] || !weigh(point)) return kNone;
    float sum = 0, nearest = 0, all = 0;
    glm::vec3 mean(0.0f);
    for (const auto& [j, weight] : std::span(neighbour_).first(around_)) {
        sum += weight;
        nearest += weight * near_[j];
        all += weight * all_[j];
        mean += weight * mean_[j];
    }
    const float part = glm::smoothstep(kTexture, kRandom, nearest / std::max(all, 1e-9f)) *
                       glm::smoothstep(kInvisible, kVisible, all / sum);
    const auto steps = [&](int c) {
        const float change = kColourChangeSteps * part * (mean[c] / sum - color_of_[point][c]);
        return static_cast<int>(
            std::lround(std::clamp(change, -1.0f * kColourChangeSteps, 1.0f * kColourChangeSteps)));
    };
    const int green = steps(1);
    return {static_cast<int8_t>(green), static_cast<int8_t>(steps(0) - green),
            static_cast<int8_t>(steps(2) - green)};
}

}  // namespace lucarne::octree
