#include "io/formats/ply/layout.h"

#include <algorithm>
#include <array>

#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::ply {
namespace {

using Triple = std::array<std::string_view, 3>;
constexpr std::array<Triple, 3> kColorNames = {
    {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}, {"r", "g", "b"}}};
constexpr std::array<Triple, 2> kNormalNames = {{{"nx", "ny", "nz"}, {"normal_x", "normal_y", "normal_z"}}};

constexpr std::array kKnown = {names::intensity,       names::classification,
                               names::return_number,   names::number_of_returns,
                               names::scan_direction,  names::edge_of_flight_line,
                               names::class_flags,     names::scanner_channel,
                               names::scan_angle_rank, names::scan_angle,
                               names::user_data,       names::point_source_id,
                               names::gps_time,        names::nir};

bool is_real(ScalarType type) {
    return type == ScalarType::f32 || type == ScalarType::f64;
}

class LayoutMaker {
 public:
    LayoutMaker(const std::vector<Property>& properties, Encoding encoding) {
        layout_.big_endian = encoding == Encoding::big_endian;
        for (const Property& p : properties) {
            if (p.count) continue;
            properties_.push_back(p);
            layout_.columns.push_back({p, "", 0});
            offsets_.push_back(layout_.packed_bytes);
            layout_.packed_bytes += static_cast<uint32_t>(scalar_bytes(p.type));
        }
    }

    Layout make() {
        position();
        for (size_t i = 0; i < properties_.size(); ++i) {
            if (done_[i] || properties_[i].name.empty()) continue;
            if (group(i, kColorNames, names::color) || group(i, kNormalNames, names::normal)) continue;
            std::string name = attribute_name(i);
            // These names imply a shape that a single property does not have.
            for (const auto reserved : {names::color, names::normal, names::normal_oct, names::area})
                if (name == reserved) name.insert(0, "ply_");
            layout_.schema.add(unique_name(layout_.schema, name), properties_[i].type);
            copy(i, layout_.schema.attributes.back().offset);
            layout_.columns[i].attribute = layout_.schema.attributes.back().name;
        }
        return std::move(layout_);
    }

 private:
    size_t index(std::string_view name) const { return index_of_name(properties_, name, &Property::name); }

    /// Returns the attribute name of a property: one of io::names, regardless of case, if it matches.
    std::string attribute_name(size_t property) const {
        const std::string& theirs = properties_[property].name;
        for (const std::string_view ours : kKnown)
            if (same_letters(theirs, ours) && index(ours) == property) return std::string(ours);
        return theirs;
    }

    void position() {
        done_.assign(properties_.size(), false);
        const std::array<size_t, 3> axes = {index("x"), index("y"), index("z")};
        layout_.flat = axes[2] == properties_.size();
        bool floats = true;
        for (const size_t axis : axes)
            floats = floats && (axis == properties_.size() || properties_[axis].type == ScalarType::f32);
        layout_.schema.position = floats ? PositionType::f32 : PositionType::f64;
        layout_.schema.stride = static_cast<uint32_t>(position_bytes(layout_.schema.position));
        for (uint32_t k = 0; k < 3; ++k) {
            const size_t axis = axes[k];
            if (axis == properties_.size()) continue;
            layout_.columns[axis].component = k;
            if (floats || properties_[axis].type == ScalarType::f64) {
                copy(axis, k * (floats ? 4 : 8));
            } else {
                convert(Layout::Step::Kind::to_double, axis, 8 * k);
            }
        }
    }

    /// Returns the type of an attribute of these three components; empty if they cannot form one.
    std::optional<ScalarType> common(const std::array<size_t, 3>& members, bool color) const {
        const ScalarType first = properties_[members[0]].type;
        const auto all = [&](const auto& holds) {
            return std::ranges::all_of(members, [&](size_t m) { return holds(properties_[m].type); });
        };
        if (is_real(first) && all([&](ScalarType type) { return type == first; })) return first;
        if (!color) return std::nullopt;
        // Some writers say char where they mean uchar; the bits are the same.
        if (all([](ScalarType type) { return scalar_bytes(type) == 1; })) return ScalarType::u8;
        return all([](ScalarType type) { return !is_real(type); }) ? std::optional(ScalarType::u16)
                                                                   : std::nullopt;
    }

    template <size_t N>
    bool group(size_t first, const std::array<Triple, N>& spellings, std::string_view name) {
        if (layout_.schema.find(name)) return false;
        for (const Triple& triple : spellings) {
            // A quick check first: few of the possibly thousands of properties are worth searching for.
            if (std::ranges::none_of(triple, [&](auto name_of_one) {
                    return same_letters(name_of_one, properties_[first].name);
                }))
                continue;
            const std::array<size_t, 3> members = {index(triple[0]), index(triple[1]), index(triple[2])};
            if (std::find(members.begin(), members.end(), first) == members.end()) continue;
            if (*std::max_element(members.begin(), members.end()) == properties_.size()) continue;
            const auto type = common(members, name == names::color);
            if (!type) continue;
            layout_.schema.add(std::string(name), *type, 3);
            const auto at = layout_.schema.attributes.back().offset;
            for (uint32_t k = 0; k < 3; ++k) {
                const uint32_t to = at + k * static_cast<uint32_t>(scalar_bytes(*type));
                const ScalarType from = properties_[members[k]].type;
                if (*type == ScalarType::u16 && from != ScalarType::u16)
                    convert(Layout::Step::Kind::to_u16, members[k], to);
                else
                    copy(members[k], to);
                layout_.columns[members[k]].attribute = name;
                layout_.columns[members[k]].component = k;
            }
            return true;
        }
        return false;
    }

    void convert(Layout::Step::Kind kind, size_t property, uint32_t to) {
        layout_.steps.push_back({kind, properties_[property].type, offsets_[property], to, 1});
        done_[property] = true;
    }

    void copy(size_t property, uint32_t to) {
        const auto bytes = static_cast<uint32_t>(scalar_bytes(properties_[property].type));
        const auto kind =
            layout_.big_endian && bytes > 1 ? Layout::Step::Kind::swap : Layout::Step::Kind::copy;
        Layout::Step step{kind, properties_[property].type, offsets_[property], to, 1};
        done_[property] = true;
        // Neighbouring scalars go in one step. A copy step counts bytes.
        if (kind == Layout::Step::Kind::copy) step.count = bytes;
        if (!layout_.steps.empty()) {
            auto& last = layout_.steps.back();
            const uint32_t width = kind == Layout::Step::Kind::copy ? 1 : bytes;
            const bool alike =
                last.kind == kind && (kind == Layout::Step::Kind::copy || scalar_bytes(last.type) == bytes);
            if (alike && last.from + last.count * width == step.from && last.to + last.count * width == to) {
                last.count += step.count;
                return;
            }
        }
        layout_.steps.push_back(step);
    }

    Layout layout_;
    std::vector<Property> properties_;  ///< without lists
    std::vector<uint32_t> offsets_;
    std::vector<bool> done_;
};

template <class T>
void swap_run(const std::byte* from, std::byte* to, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
        T value = load<T>(from + i * sizeof(T));
        if constexpr (sizeof(T) == 2) value = __builtin_bswap16(value);
        if constexpr (sizeof(T) == 4) value = __builtin_bswap32(value);
        if constexpr (sizeof(T) == 8) value = __builtin_bswap64(value);
        store(to + i * sizeof(T), value);
    }
}

void swap_scalars(size_t bytes, const std::byte* from, std::byte* to, uint32_t count) {
    switch (bytes) {
        case 2:
            return swap_run<uint16_t>(from, to, count);
        case 4:
            return swap_run<uint32_t>(from, to, count);
        case 8:
            return swap_run<uint64_t>(from, to, count);
        default:
            std::memcpy(to, from, count);
    }
}

}  // namespace

bool Layout::unpack(const std::byte* packed, std::byte* record) const {
    if (flat) std::memset(record, 0, position_bytes(schema.position));
    for (const Step& step : steps) {
        switch (step.kind) {
            case Step::Kind::copy:
                std::memcpy(record + step.to, packed + step.from, step.count);
                break;
            case Step::Kind::swap:
                swap_scalars(scalar_bytes(step.type), packed + step.from, record + step.to, step.count);
                break;
            case Step::Kind::to_double:
            case Step::Kind::to_u16: {
                std::array<std::byte, 8> native{};
                const size_t bytes = scalar_bytes(step.type);
                if (big_endian)
                    swap_scalars(bytes, packed + step.from, native.data(), 1);
                else
                    std::memcpy(native.data(), packed + step.from, bytes);
                store_scalar(step.kind == Step::Kind::to_u16 ? ScalarType::u16 : ScalarType::f64,
                             record + step.to, scalar_at(step.type, native.data()));
                break;
            }
        }
    }
    const glm::dvec3 at = position_of(schema, record);
    return usable(at.x) && usable(at.y) && usable(at.z);
}

Layout make_layout(const std::vector<Property>& properties, Encoding encoding) {
    return LayoutMaker(properties, encoding).make();
}

}  // namespace lucarne::io::ply
