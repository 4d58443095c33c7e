#include "gi/surfels/point_colours.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "gi/shared/surfel_code.h"
#include "octree/colours/even_colours.h"

namespace lucarne::gi {
namespace {

// Along the cube, at the finest: a few times the spacing of the node's samples.
constexpr int kCells = 32;

constexpr int kBlackCells = 16;
/// Where photographs end, their last pixels are blends with black. Darker points than this, as a share of
/// white, that are near points without a photograph count as such.
constexpr double kBlend = 16.5 / 255;

bool all_zero(const std::byte* at, size_t bytes) {
    return std::all_of(at, at + bytes, [](std::byte b) { return b == std::byte{0}; });
}

/// sRGB to linear, exact to a thousandth: for means.
float nearly_linear(double srgb) {
    static const auto kTable = [] {
        std::array<float, 1024> table{};
        for (size_t i = 0; i < table.size(); ++i) table[i] = srgb_to_linear(static_cast<float>(i) / 1023);
        return table;
    }();
    return srgb >= 0 && srgb <= 1 ? kTable[static_cast<size_t>(srgb * 1023 + 0.5)] : 0.0f;
}

size_t index_of(const glm::ivec3& cell, int cells) {
    return static_cast<size_t>((cell.z * cells + cell.y) * cells + cell.x);
}

/// Limits a place to [0, cells - 1]; NaN, which damaged files hold, becomes 0.
glm::dvec3 within(const glm::dvec3& place, int cells) {
    return glm::min(glm::max(glm::dvec3(0), place), glm::dvec3(cells - 1));
}

size_t cell_of(const glm::dvec3& position, const octree::Cube& cube, int cells) {
    return index_of(glm::ivec3(within((position - cube.min) / cube.size * double(cells), cells)), cells);
}

}  // namespace

PointColours::PointColours(const octree::SourceHeader& header, const octree::Cube& cube,
                           const octree::NodeData& data, bool balanced)
    : header_(header), cube_(cube), data_(data), keys_(header.schema), balanced_(balanced) {
    const auto* color = header.schema.find(io::names::color);
    if (!color || color->components != 3) return;
    const auto fills = [](const octree::StationColour& colour) { return colour.unphotographed.has_value(); };
    const bool fill = balanced && std::ranges::any_of(header.station_colours, fills);
    // Scans without a camera often have colour fields that were never filled.
    bool filled = fill;
    for (size_t at = color->offset; !filled && at < data.records.size(); at += header.schema.stride)
        filled = !all_zero(&data.records[at], color->bytes());
    if (!filled) return;
    color_ = color;
    const auto* change = header.schema.find(io::names::color_change);
    const bool known = change && change->type == io::ScalarType::i8 && change->components == 3;
    if (balanced && known) change_ = change;
    if (fill) mark_black_cells();
}

void PointColours::mark_black_cells() {
    const size_t stride = header_.schema.stride;
    for (size_t at = 0; at + stride <= data_.records.size(); at += stride) {
        const std::byte* record = &data_.records[at];
        if (!all_zero(record + color_->offset, color_->bytes())) continue;
        const octree::StationColour* colour = station_of(record).colour;
        if (!colour || !colour->unphotographed) continue;
        black_.resize(size_t{kBlackCells} * kBlackCells * kBlackCells);
        black_[cell_of(io::position_of(header_.schema, record), cube_, kBlackCells)] = true;
    }
}

const PointColours::Station& PointColours::station_of(const std::byte* record) {
    const octree::StationKey key = keys_.of(record);
    if (last_ && last_->key == key) return *last_;
    Station station{.key = key};
    if (key.scan < header_.scans.size()) {
        station.white = io::color_white(header_.scans[key.scan].color_bits);
    } else {
        const io::ScalarType type = color_->type;
        station.white = io::color_white(type == io::ScalarType::u8    ? 8
                                        : type == io::ScalarType::u16 ? 16
                                                                      : 0);
    }
    if (balanced_) station.colour = octree::find_colour(header_.station_colours, key);
    if (station.colour) station.curves = curves_of(*station.colour);
    last_ = station;
    return *last_;
}

const PointColours::Curves* PointColours::curves_of(const octree::StationColour& colour) {
    if (colour.gain == glm::dvec3(1.0)) return nullptr;
    auto& curves = curves_[&colour];
    if (curves) return curves.get();
    auto made = std::make_unique<Curves>();
    for (int c = 0; c < 3; ++c)
        for (size_t i = 0; i < (*made)[0].size(); ++i) {
            const float linear =
                srgb_to_linear(static_cast<float>(i) / 255) * static_cast<float>(colour.gain[c]);
            (*made)[static_cast<size_t>(c)][i] = linear_to_srgb(std::min(linear, 1.0f));
        }
    curves = std::move(made);
    return curves.get();
}

glm::dvec3 PointColours::raw(const std::byte* record) const {
    const std::byte* at = record + color_->offset;
    const size_t step = io::scalar_bytes(color_->type);
    return {io::scalar_at(color_->type, at), io::scalar_at(color_->type, at + step),
            io::scalar_at(color_->type, at + 2 * step)};
}

glm::dvec3 PointColours::balanced(const std::byte* record, const glm::dvec3& raw,
                                  const Station& station) const {
    glm::dvec3 srgb = raw / station.white;
    if (change_) {
        const auto change = io::load<octree::ColourChange>(record + change_->offset);
        if (change != octree::ColourChange{}) srgb = octree::changed_colour(srgb, change);
    }
    if (!station.curves) return srgb;
    for (int c = 0; c < 3; ++c) {
        const auto& curve = (*station.curves)[static_cast<size_t>(c)];
        const double place = srgb[c] > 0 ? std::min(255 * srgb[c], 255.0) : 0.0;  // NaN becomes 0
        const auto i = static_cast<size_t>(place);
        srgb[c] = glm::mix(double{curve[i]}, double{curve[i + 1]}, place - static_cast<double>(i));
    }
    return srgb;
}

bool PointColours::never_photographed(const glm::dvec3& raw, const glm::dvec3& position,
                                      const Station& station) const {
    if (black_.empty() || !station.colour || !station.colour->unphotographed) return false;
    return raw == glm::dvec3(0.0) || (std::max({raw.x, raw.y, raw.z}) <= kBlend * station.white &&
                                      black_[cell_of(position, cube_, kBlackCells)]);
}

std::optional<glm::dvec3> PointColours::of(const std::byte* record, const glm::dvec3& position) {
    if (!color_) return std::nullopt;
    const Station& station = station_of(record);
    const glm::dvec3 colour = raw(record);
    if (never_photographed(colour, position, station))
        return colour_around(position,
                             glm::min(*station.colour->unphotographed * station.colour->gain, glm::dvec3(1)));
    return balanced(record, colour, station);
}

void PointColours::sum_up_cells() {
    cells_.assign(1, std::vector<glm::vec4>(size_t{kCells} * kCells * kCells));
    const size_t stride = header_.schema.stride;
    for (size_t at = 0; at + stride <= data_.records.size(); at += stride) {
        const std::byte* record = &data_.records[at];
        const Station& station = station_of(record);
        const glm::dvec3 colour = raw(record);
        const glm::dvec3 position = io::position_of(header_.schema, record);
        if (never_photographed(colour, position, station)) continue;
        glm::vec4 sum(0, 0, 0, 1);
        const glm::dvec3 srgb = balanced(record, colour, station);
        for (int c = 0; c < 3; ++c) sum[c] = nearly_linear(srgb[c]);
        cells_[0][cell_of(position, cube_, kCells)] += sum;
    }
    for (int cells = kCells / 2; cells > 0; cells /= 2) {
        const std::vector<glm::vec4>& fine = cells_.back();
        std::vector<glm::vec4> coarse(size_t(cells) * size_t(cells) * size_t(cells));
        for (int z = 0; z < 2 * cells; ++z)
            for (int y = 0; y < 2 * cells; ++y)
                for (int x = 0; x < 2 * cells; ++x)
                    coarse[index_of({x / 2, y / 2, z / 2}, cells)] += fine[index_of({x, y, z}, 2 * cells)];
        cells_.push_back(std::move(coarse));
    }
}

/// Returns the mean over the finest cells that have colours among the eight around the position, weighted
/// trilinearly; `otherwise`, which is linear, in a node without any colours.
glm::dvec3 PointColours::colour_around(const glm::dvec3& position, const glm::dvec3& otherwise) {
    if (cells_.empty()) sum_up_cells();
    const glm::dvec3 place = (position - cube_.min) / cube_.size;
    glm::dvec4 sum(0.0);
    for (int level = 0, cells = kCells; cells > 0 && !(sum.w > 0); ++level, cells /= 2) {
        const glm::dvec3 from = within(place * static_cast<double>(cells) - 0.5, cells);
        const glm::ivec3 low(from);
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
            const glm::dvec3 share =
                glm::mix(1.0 - (from - glm::dvec3(low)), from - glm::dvec3(low), glm::dvec3(step));
            const glm::ivec3 cell = glm::min(low + step, glm::ivec3(cells - 1));
            sum += share.x * share.y * share.z *
                   glm::dvec4(cells_[static_cast<size_t>(level)][index_of(cell, cells)]);
        }
    }
    glm::dvec3 srgb;
    for (int c = 0; c < 3; ++c)
        srgb[c] = linear_to_srgb(static_cast<float>(sum.w > 0 ? sum[c] / sum.w : otherwise[c]));
    return srgb;
}

}  // namespace lucarne::gi
