#include "tests/added_engine/paint/mean_colour.h"

#include <cstring>

#include "tests/added_engine/paint/options.h"
#include "tests/added_engine/paint/paint.h"

namespace lucarne::gi::paint {
namespace {

class ColourSums final : public Precomputation {
 public:
    Result<void> restore(const BakeInput&, const BakeSections& sections) override {
        const auto found = sections.find("sums");
        State read;
        if (found == sections.end() || found->second.size() != sizeof(State))
            return rejected("paint", "the sums are damaged");
        std::memcpy(&read, found->second.data(), sizeof(State));
        if (read.done > kMeanSteps) return rejected("paint", "the sums are damaged");
        state_ = read;
        return {};
    }
    std::vector<Step<const BakeInput>> steps(const BakeInput&) override {
        return std::vector<Step<const BakeInput>>(
            kMeanSteps - state_.done, {"colours", [this](const BakeInput& input) -> Result<StepResult> {
                                           if (paint_hooks().before) paint_hooks().before(state_.done);
                                           sum(input);
                                           ++paint_hooks().steps;
                                           return StepResult::done;
                                       }});
    }
    double share() const override { return static_cast<double>(state_.done) / kMeanSteps; }
    std::shared_ptr<const Bake> snapshot() const override {
        if (!(state_.area > 0)) return nullptr;
        auto bake = std::make_shared<MeanColour>();
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

}  // namespace

std::unique_ptr<Precomputation> sum_colours() {
    return std::make_unique<ColourSums>();
}

}  // namespace lucarne::gi::paint
