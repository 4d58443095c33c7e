#include "io/formats/common/color_depth.h"

#include <algorithm>

namespace lucarne::io {

ColorDepth::ColorDepth(const Schema& schema) : stride_(schema.stride) {
    const Attribute* color = schema.find(names::color);
    if (!color || color->components != 3 || scalar_bytes(color->type) == 1) return;
    offset_ = color->offset;
    type_ = color->type;
    whole_ = type_ != ScalarType::f32 && type_ != ScalarType::f64;
    open_ = true;
}

void ColorDepth::add(std::span<const std::byte> records) {
    if (!open()) return;
    const size_t step = scalar_bytes(type_);
    for (size_t at = offset_; at < records.size(); at += stride_)
        for (size_t c = 0; c < 3; ++c) {
            const double value = type_ == ScalarType::u16 ? load<uint16_t>(&records[at + c * step])
                                                          : scalar_at(type_, &records[at + c * step]);
            if (value > largest_ && value < 1e300) largest_ = value;  // infinity is no colour
        }
}

uint32_t sampled_color_bits(const PointSource& scan) {
    constexpr uint64_t kBlocks = 64, kBlockPoints = 256, kParts = 16, kFrontPoints = 4096;
    const Schema& schema = scan.schema();
    ColorDepth depth(schema);
    PointBatch batch;
    const auto take = [&](const Result<void>& done) {
        if (done) depth.add(std::span(batch.bytes).first(batch.count * schema.stride));
    };
    if (scan.seekable()) {
        const uint64_t points = scan.info().declared_points;
        std::vector<uint64_t> indices;
        for (uint64_t block = 0; block < std::min(kBlocks, points) && depth.open(); ++block) {
            const auto first = static_cast<uint64_t>(static_cast<__uint128_t>(points) * block / kBlocks);
            indices.clear();
            for (uint64_t i = first; i < std::min(points, first + kBlockPoints); ++i) indices.push_back(i);
            take(scan.pick(indices, batch));
        }
        return depth.bits();
    }
    const size_t parts = scan.parts(), taken = std::min<size_t>(kParts, parts);
    const size_t most = parts == 1 ? kBlocks * kBlockPoints : kFrontPoints;
    for (size_t i = 0; i < taken && depth.open(); ++i) take(scan.front(i * parts / taken, most, batch));
    return depth.bits();
}

}  // namespace lucarne::io
