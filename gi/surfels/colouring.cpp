#include "gi/surfels/colouring.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lucarne::gi {
namespace {

constexpr uint64_t kColoursSampled = 20'000;  // least number of points to measure a range on; whole levels
constexpr size_t kSampledRoots = 16;
constexpr double kTail = 0.01;  // share of the points that a range leaves out at each end

uint32_t ten_bits(double v) {
    return v > 0 ? static_cast<uint32_t>(std::lround(std::min(v, 1.0) * 1023)) : 0u;
}

/// Finds the column of "name", or of "name.1" for the second component and so on.
std::optional<ValueColumn> column_of(const io::Schema& schema, std::string_view name) {
    uint32_t component = 0;
    const io::Attribute* found = schema.find(name);
    if (const size_t dot = name.rfind('.'); !found && dot != std::string_view::npos) {
        const std::string_view digits = name.substr(dot + 1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), component);
        if (error == std::errc() && end == digits.data() + digits.size())
            found = schema.find(name.substr(0, dot));
    }
    if (!found || component >= found->components) return std::nullopt;
    return ValueColumn{found->type,
                       found->offset + component * static_cast<uint32_t>(io::scalar_bytes(found->type))};
}

std::string_view attribute_name(const Look& look) {
    switch (look.colour) {
        case ColourBy::colour:
            return io::names::color;
        case ColourBy::intensity:
            return io::names::intensity;
        case ColourBy::classification:
            return io::names::classification;
        case ColourBy::return_number:
            return io::names::return_number;
        case ColourBy::attribute:
            return look.attribute;
        case ColourBy::elevation:
        case ColourBy::scan:
        case ColourBy::normal:
        case ColourBy::clay:
            break;
    }
    return {};
}

/// Values collected from the sampled points.
struct Sampled {
    std::vector<double> values;  ///< finite values, for looks with a range
    std::bitset<256> numbers, classes;
};

void mark(std::bitset<256>& numbers, double number) {
    if (number >= 0 && number < 256) numbers.set(static_cast<size_t>(number));
}

void sample(const octree::SourcePart& part, const Look& look, const octree::NodeData& data,
            Sampled& sampled) {
    const io::Schema& schema = part.header.schema;
    const auto shown = value_column(schema, look), classes = column_of(schema, io::names::classification);
    const auto scans = column_of(schema, io::names::scan);
    const bool ranged = has_range(look.colour), elevation = look.colour == ColourBy::elevation;
    const size_t count = std::min<size_t>(data.count, data.records.size() / schema.stride);
    for (size_t i = 0; i < count; ++i) {
        const std::byte* record = data.records.data() + i * schema.stride;
        if (classes) mark(sampled.classes, classes->at(record));
        if (look.colour == ColourBy::scan)
            mark(sampled.numbers, part.first_scan + (scans ? scans->at(record) : 0));
        if (!shown && !elevation) continue;
        const double value = elevation ? io::position_of(schema, record).z * part.scale : shown->at(record);
        if (!ranged) mark(sampled.numbers, value);
        if (ranged && std::isfinite(value)) sampled.values.push_back(value);
    }
}

ValueRange range_of(std::vector<double>& values) {
    const auto at = [&](double share) {
        const auto place =
            static_cast<ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
        std::nth_element(values.begin(), values.begin() + place, values.end());
        return values[static_cast<size_t>(place)];
    };
    return {at(kTail), at(1 - kTail)};
}

}  // namespace

std::optional<ValueColumn> value_column(const io::Schema& schema, const Look& look) {
    if (look.colour == ColourBy::colour) return std::nullopt;
    const std::string_view name = attribute_name(look);
    return name.empty() ? std::nullopt : column_of(schema, name);
}

uint32_t pack_colour(const glm::dvec3& srgb) {
    return ten_bits(srgb.x) | ten_bits(srgb.y) << 10 | ten_bits(srgb.z) << 20;
}

Colouring::Colouring(const io::Schema& schema, const Look& look, uint32_t first_scan)
    : by_(look.colour),
      column_(value_column(schema, look)),
      range_(look.range.value_or(ValueRange{})),
      first_scan_(first_scan) {
    if (has_range(by_)) {
        for (size_t i = 0; i < kShades; ++i) {
            const double place = static_cast<double>(i) / (kShades - 1);
            shades_[i] = pack_colour(glm::dvec3(mapped_colour(look.map, look.reversed ? 1 - place : place)));
        }
    } else if (by_ == ColourBy::classification) {
        for (size_t i = 0; i < 256; ++i)
            shades_[i] = pack_colour(glm::dvec3(class_colour(static_cast<uint8_t>(i))));
    } else {
        for (size_t i = 0; i < 256; ++i) shades_[i] = pack_colour(glm::dvec3(ordinal_colour(i)));
    }
}

uint32_t Colouring::shade(double value) const {
    const double span = range_.high - range_.low;
    const double place = span != 0 ? (value - range_.low) / span : value < range_.low ? 0.0 : 1.0;
    const double step = place > 0 ? std::min(place, 1.0) * (kShades - 1) : 0.0;  // NaN: 0
    return shades_[static_cast<size_t>(std::lround(step))];
}

std::optional<uint32_t> Colouring::colour(const std::byte* record, double z, uint32_t scan,
                                          const glm::vec3& normal) const {
    static const uint32_t kNone = pack_colour(glm::dvec3(0.5));  // for points without the attribute
    static const uint32_t kClay = pack_colour(glm::dvec3(0.8, 0.78, 0.75));
    switch (by_) {
        case ColourBy::colour:
            return std::nullopt;
        case ColourBy::clay:
            return kClay;
        case ColourBy::elevation:
            return shade(z);
        case ColourBy::scan:
            return pack_colour(glm::dvec3(ordinal_colour(uint64_t{scan} + first_scan_)));
        case ColourBy::normal:
            return normal == glm::vec3(0.0f) ? kNone : pack_colour(glm::dvec3(normal) * 0.5 + 0.5);
        case ColourBy::intensity:
        case ColourBy::attribute:
            return column_ ? shade(column_->at(record)) : kNone;
        case ColourBy::classification:
        case ColourBy::return_number:
            break;
    }
    if (!column_) return kNone;
    const double number = column_->at(record);
    return shades_[number > 0 ? static_cast<size_t>(std::min(number, 255.0)) : 0];  // NaN: 0
}

ShownValues measured_values(const octree::NodeSource& source, const Look& look) {
    // Goes level by level, from at most kSampledRoots roots.
    const std::vector<uint32_t> roots = source.roots();
    std::vector<uint32_t> level, below;
    const size_t used = std::min(roots.size(), kSampledRoots);
    for (size_t i = 0; i < used; ++i) level.push_back(roots[i * roots.size() / used]);
    Sampled sampled;
    const auto nodes = source.nodes();
    for (uint64_t points = 0; !level.empty() && points < kColoursSampled; level.swap(below)) {
        below.clear();
        for (const uint32_t node : level) {
            const Result<octree::NodeData> data = source.load(node);
            if (!data) continue;  // drawing the node reports the error
            points += data->count;
            sample(source.part_of(node), look, *data, sampled);
            for (uint32_t octant = 0; octant < 8; ++octant)
                if (const uint32_t child = nodes[node].child(octant); child != octree::kNoNode)
                    below.push_back(child);
        }
    }
    ShownValues shown{look.range, sampled.numbers, sampled.classes};
    if (!has_range(look.colour) || sampled.values.empty())
        shown.range.reset();
    else if (!shown.range)
        shown.range = range_of(sampled.values);
    return shown;
}

Result<void> check_attribute(const octree::NodeSource& source, const Look& look) {
    const std::string_view wanted = attribute_name(look);
    if (wanted.empty() || look.colour == ColourBy::colour) return {};
    std::set<std::string> known;
    for (const uint32_t root : source.roots()) {
        const io::Schema& schema = source.part_of(root).header.schema;
        if (column_of(schema, wanted)) return {};
        for (const io::Attribute& attribute : schema.attributes) known.insert(attribute.name);
    }
    return bad_arguments(fmt::format("colour by {}", wanted), "no point has this attribute",
                         fmt::format("there are: {}", fmt::join(known, ", ")));
}

}  // namespace lucarne::gi
