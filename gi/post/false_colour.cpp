#include "gi/post/false_colour.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "gi/post/bindings.h"
#include "gi/scene/photometry.h"
#include "gi/shared/brdf.h"

namespace lucarne::gi {
namespace {

constexpr const char* kFalseColour = "gi/post/false_colour.comp";
constexpr size_t kRamp = 64;
constexpr double kStops = 5;  // on each side of mid-grey, for automatic false colours

struct Scale {
    std::optional<uint32_t> mode;  ///< of false_colour.comp
    double gain, offset;
    ColourMap map;
};

/// The places of figures on the logarithmic scale of a range.
Scale logarithmic(const ValueRange& range, std::optional<uint32_t> mode) {
    const double low = std::log2(range.low / kLumensPerWatt), high = std::log2(range.high / kLumensPerWatt);
    const double gain = 1 / std::max(high - low, 1e-6);
    return {mode, gain, -low * gain, kLuminanceMap};
}

Result<void> paint(Device& device, const char* shader, const Buffer& radiance, const Buffer& other,
                   uint32_t pixels, const Scale& scale, Buffer& picture) {
    LUCARNE_ASSIGN(const Program* program, device.program(shader, {{"RAMP", std::to_string(kRamp)}}));
    LUCARNE_TRY(device.reserve(picture, size_t{pixels} * sizeof(uint32_t), "picture"));
    std::vector<float> ramp;
    for (size_t i = 0; i < kRamp; ++i) {
        const glm::vec3 colour = mapped_colour(scale.map, static_cast<double>(i) / (kRamp - 1));
        ramp.insert(ramp.end(), {colour.x, colour.y, colour.z, 1.0f});
    }
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    other.bind(post::kBindOther);
    program->set("pixels", pixels);
    if (scale.mode) program->set("mode", *scale.mode);
    program->set("gain", static_cast<float>(scale.gain));
    program->set("offset", static_cast<float>(scale.offset));
    program->set_block("ramp", ramp);
    program->dispatch(pixels);
    return {};
}

}  // namespace

ValueRange false_colour_range(ToneMap shown, const std::optional<ValueRange>& wanted, double ev) {
    if (wanted) return *wanted;
    const double grey = shown == ToneMap::illuminance ? static_cast<double>(kPi) : 0.18;
    const double middle = grey * std::exp2(-ev) * kLumensPerWatt;
    return {middle * std::exp2(-kStops), middle * std::exp2(kStops)};
}

Result<void> false_colour(Device& device, const Buffer& radiance, uint32_t pixels, const ValueRange& range,
                          Buffer& picture) {
    return paint(device, kFalseColour, radiance, radiance, pixels, logarithmic(range, 0), picture);
}

Result<void> illuminance(Device& device, const Buffer& radiance, const GBuffer& gbuffer,
                         const Buffer& materials, const ValueRange& range, Buffer& picture) {
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    materials.bind(post::kBindMaterials);
    return paint(device, "gi/post/illuminance.comp", radiance, radiance, gbuffer.width * gbuffer.height,
                 logarithmic(range, std::nullopt), picture);
}

Result<void> difference(Device& device, const Buffer& radiance, const Buffer& other, uint32_t pixels,
                        bool absolute, double ev, double range, Buffer& picture) {
    const double gain = std::exp2(ev) / range;
    const Scale scale = absolute ? Scale{2, gain, 0, kDifferenceMap} : Scale{1, gain / 2, 0.5, kSignedMap};
    return paint(device, kFalseColour, radiance, other, pixels, scale, picture);
}

Result<void> split(Device& device, const Buffer& other, uint32_t width, uint32_t height, double border,
                   Buffer& picture) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/split.comp"));
    other.bind(post::kBindOther);
    picture.bind(post::kBindPicture);
    program->set("pixels", width * height);
    program->set("width", width);
    program->set("border", static_cast<uint32_t>(std::lround(std::clamp(border, 0.0, 1.0) * width)));
    program->dispatch(width * height);
    return {};
}

}  // namespace lucarne::gi
