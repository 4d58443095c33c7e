#include "tests/added_engine/paint/paint.h"

#include <array>

#include "gi/host_frame.h"

namespace lucarne::gi {
namespace {

constexpr std::array<std::string_view, 2> kPatterns = {"plain", "stripes"};

constexpr Option<glm::dvec3> kTint{
    {.kind = OptionKind::colour,
     .key = "tint",
     .label = "tint",
     .help = "Colour of all surfaces",
     .defaults = {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}}};
constexpr Option<double> kGain{{.kind = OptionKind::number,
                                .key = "paint_gain",
                                .label = "gain",
                                .help = "Factor of the colour",
                                .cost = "nothing",
                                .least = 0.5,
                                .most = 8,
                                .slider = {0.5, 8},
                                .defaults = {1.0, 1.0, 1.0}}};
constexpr Option<uint32_t> kWidth{{.kind = OptionKind::integer,
                                   .key = "stripe_width",
                                   .label = "stripe width",
                                   .help = "Pixels of a stripe",
                                   .least = 1,
                                   .most = 64,
                                   .slider = {1, 16},
                                   .defaults = {int64_t{8}, int64_t{4}, int64_t{2}},
                                   .cheaper = 1}};
enum class Pattern { plain, stripes };
constexpr Option<Pattern> kPattern{{.kind = OptionKind::choice,
                                    .key = "pattern",
                                    .label = "pattern",
                                    .help = "What is painted",
                                    .choices = kPatterns,
                                    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}}}};
constexpr Option<bool> kPaintSky{{.kind = OptionKind::flag,
                                  .key = "paint_sky",
                                  .label = "sky as well",
                                  .help = "Paint where no surface is, too",
                                  .defaults = {false, false, false}}};

constexpr const OptionInfo* kOptions[] = {&kTint.info, &kGain.info, &kWidth.info, &kPattern.info,
                                          &kPaintSky.info};
constexpr EngineInfo kInfo{
    .name = "paint", .label = "Paint", .description = "one colour", .options = kOptions};

class PaintEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 protected:
    Result<void> prepare(Frame&) override { return {}; }
    Result<void> render(Frame& frame) override {
        const EngineSettings& s = frame.settings;
        const auto texels = download_gbuffer(frame);
        std::vector<glm::vec4> radiance(texels.size(), glm::vec4(0.0f));
        const glm::vec4 colour(glm::vec3(s[kTint] * s[kGain]), 1.0f);
        for (size_t i = 0; i < texels.size(); ++i) {
            const bool striped =
                s[kPattern] == Pattern::stripes && i % frame.camera.width / s[kWidth] % 2 == 1;
            if ((texels[i].depth > 0 || s[kPaintSky]) && !striped) radiance[i] = colour;
        }
        upload_radiance(frame, radiance);
        return {};
    }
};

}  // namespace

EngineEntry paint_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<PaintEngine>(); }};
}

}  // namespace lucarne::gi
