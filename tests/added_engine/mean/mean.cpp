#include "tests/added_engine/mean/mean.h"

#include <cstring>

#include "gi/bake/precomputation.h"
#include "gi/host_frame.h"

namespace lucarne::gi {
namespace {

constexpr Option<double> kMeanScale{{.kind = OptionKind::number,
                                     .key = "mean_scale",
                                     .label = "scale",
                                     .help = "Factor of the mean colour, computed in advance",
                                     .least = 1,
                                     .most = 4,
                                     .slider = {1, 4},
                                     .defaults = {1.0, 1.0, 1.0}}};
constexpr Option<double> kMeanGain{{.kind = OptionKind::number,
                                    .key = "mean_gain",
                                    .label = "gain",
                                    .help = "Factor of the mean colour in the picture",
                                    .least = 1,
                                    .most = 4,
                                    .slider = {1, 4},
                                    .defaults = {1.0, 1.0, 1.0}}};

struct MeanBake final : Bake {
    glm::dvec3 mean{0.0};
};

/// Sums the colours by area, an eighth of the surfels a step.
class MeanOfColours final : public Precomputation {
 public:
    Result<void> restore(const BakeInput&, const BakeSections& sections) override {
        const auto found = sections.find("sums");
        State read;
        if (found == sections.end() || found->second.size() != sizeof(State))
            return rejected("mean", "the sums are damaged");
        std::memcpy(&read, found->second.data(), sizeof(State));
        if (read.done > kMeanSteps) return rejected("mean", "the sums are damaged");
        state_ = read;
        return {};
    }
    std::vector<Step<const BakeInput>> steps(const BakeInput&) override {
        return std::vector<Step<const BakeInput>>(
            kMeanSteps - state_.done, {"colours", [this](const BakeInput& input) -> Result<StepResult> {
                                           if (mean_hooks().before) mean_hooks().before(state_.done);
                                           sum(input);
                                           ++mean_hooks().steps;
                                           return StepResult::done;
                                       }});
    }
    double share() const override { return static_cast<double>(state_.done) / kMeanSteps; }
    std::shared_ptr<const Bake> snapshot() const override {
        if (!(state_.area > 0)) return nullptr;
        auto bake = std::make_shared<MeanBake>();
        bake->mean = state_.colour / state_.area;
        return bake;
    }
    BakeSections save() const override {
        std::vector<std::byte> bytes(sizeof(State));
        std::memcpy(bytes.data(), &state_, sizeof(State));
        return {{"sums", std::move(bytes)}};
    }

 private:
    struct State {
        glm::dvec3 colour{0.0};
        double area = 0;
        uint32_t done = 0, unused = 0;
    };
    void sum(const BakeInput& input) {
        const auto& surfels = input.cut.surfels;
        const size_t first = surfels.size() * state_.done / kMeanSteps;
        const size_t last = surfels.size() * (state_.done + 1) / kMeanSteps;
        for (size_t i = first; i < last; ++i) {
            state_.colour +=
                input.settings[kMeanScale] * double{surfels[i].area} * glm::dvec3(surfels[i].albedo);
            state_.area += surfels[i].area;
        }
        ++state_.done;
    }

    State state_;
};

constexpr const OptionInfo* kOptions[] = {&kMeanScale.info, &kMeanGain.info};
constexpr const OptionInfo* kOfBake[] = {&kMeanScale.info};
constexpr Precomputes kPrecomputes{
    .make = []() -> std::unique_ptr<Precomputation> { return std::make_unique<MeanOfColours>(); },
    .colours = true,
    .options = kOfBake};
constexpr EngineInfo kInfo{.name = "mean",
                           .label = "Mean",
                           .description = "the mean colour of the scan",
                           .options = kOptions,
                           .precomputes = &kPrecomputes};

class MeanEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 protected:
    Result<void> prepare(Frame&) override { return {}; }
    Result<void> render(Frame& frame) override {
        const auto* bake = static_cast<const MeanBake*>(frame.bake);
        const glm::vec4 colour =
            bake ? glm::vec4(glm::vec3(bake->mean * frame.settings[kMeanGain]), 1.0f) : glm::vec4(0.0f);
        const auto texels = download_gbuffer(frame);
        std::vector<glm::vec4> radiance(texels.size(), glm::vec4(0.0f));
        for (size_t i = 0; i < texels.size(); ++i)
            if (texels[i].depth > 0) radiance[i] = colour;
        upload_radiance(frame, radiance);
        return {};
    }
};

}  // namespace

EngineEntry mean_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<MeanEngine>(); }};
}

MeanHooks& mean_hooks() {
    static MeanHooks hooks;
    return hooks;
}

}  // namespace lucarne::gi
