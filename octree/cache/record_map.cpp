#include "octree/cache/record_map.h"

#include <algorithm>

namespace lucarne::octree {

using io::ScalarType;

namespace {

bool same_positions(const io::Schema& from, const io::Schema& to) {
    return from.position == to.position && (from.position != io::PositionType::i32_scaled ||
                                            (from.scale == to.scale && from.offset == to.offset));
}

}  // namespace

bool RecordMap::fits(const io::Schema& from, const io::Schema& to) {
    if (!same_positions(from, to) && to.position != io::PositionType::f64) return false;
    return std::all_of(from.attributes.begin(), from.attributes.end(), [&](const io::Attribute& attribute) {
        const auto* target = to.find(attribute.name);
        return target && target->components == attribute.components;
    });
}

RecordMap::RecordMap(const io::Schema& from, const io::Schema& to, const Rename& rename)
    : from_(from), stride_(to.stride) {
    convert_position_ = !same_positions(from, to);
    if (!convert_position_)
        steps_.push_back({.bytes = static_cast<uint32_t>(io::position_bytes(from.position))});
    for (const auto& attribute : from.attributes) {
        const auto* target = to.find(rename(attribute));
        const auto bytes = static_cast<uint32_t>(attribute.bytes());
        if (target->type == attribute.type) {
            auto* last = steps_.empty() ? nullptr : &steps_.back();
            if (last && last->components == 0 && last->from + last->bytes == attribute.offset &&
                last->to + last->bytes == target->offset)
                last->bytes += bytes;  // adjacent attributes take one copy
            else
                steps_.push_back({.from = attribute.offset, .to = target->offset, .bytes = bytes});
            continue;
        }
        const bool widened_colour = attribute.name == io::names::color && attribute.type == ScalarType::u8 &&
                                    target->type == ScalarType::u16;
        steps_.push_back({attribute.offset, target->offset, bytes, attribute.components, attribute.type,
                          target->type, widened_colour ? 257.0 : 1.0});
    }
    identical_ = from.stride == to.stride && steps_.size() == 1 && steps_[0].components == 0 &&
                 steps_[0].bytes == from.stride;
}

void RecordMap::convert(const std::byte* records, size_t count, std::vector<std::byte>& result) const {
    result.assign(count * stride_, std::byte{0});
    for (size_t i = 0; i < count; ++i) {
        const std::byte* in = records + i * from_.stride;
        std::byte* out = &result[i * stride_];
        if (convert_position_) io::store(out, io::position_of(from_, in));
        for (const Step& step : steps_) {
            if (step.components == 0) std::memcpy(out + step.to, in + step.from, step.bytes);
            for (size_t c = 0; c < step.components; ++c)
                io::store_scalar(
                    step.to_type, out + step.to + c * io::scalar_bytes(step.to_type),
                    step.factor *
                        io::scalar_at(step.from_type, in + step.from + c * io::scalar_bytes(step.from_type)));
        }
    }
}

}  // namespace lucarne::octree
