#include "gi/engines/paths/bake.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "gi/bounce_options.h"
#include "gi/engines/paths/interpolation.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/paths/path_builder.h"
#include "gi/engines/paths/store.h"
#include "io/core/log.h"

namespace lucarne::gi::paths {
namespace {

/// R- as a share of R+, and at least so many radii of a mean surfel.
constexpr float kLeastShare = 0.125f, kLeastRadii = 4;
/// The first paths, for pictures after a moment: spacing in that of all, rays, entry points; and their share
/// of the work.
constexpr float kCoarserSpacing = 3;
constexpr uint32_t kCoarseRays = 64;
constexpr uint64_t kCoarseEntries = 50'000;
constexpr double kCoarseShare = 0.05;

Spacing spacing_of(const BakeInput& input, std::span<const Surfel> surfels) {
    const float diagonal = glm::distance(input.cut.bounds.min, input.cut.bounds.max);
    double radius = 0;
    for (const Surfel& s : surfels) radius += s.radius / static_cast<double>(surfels.size());
    const float most = std::max(static_cast<float>(input.settings[kPointSpacing]) * 1e-3f * diagonal, 1e-6f);
    const float least = std::max(kLeastShare * most, kLeastRadii * static_cast<float>(radius));
    return {least, std::max(least, most)};
}

/// Makes coarse paths first, which are usable after a moment, if anything shows them; then those that were
/// asked for.
class PathsPrecomputation final : public Precomputation {
 public:
    Result<void> restore(const BakeInput& input, const BakeSections& sections) override {
        if (sections.contains("rays")) {
            LUCARNE_ASSIGN(LightPaths paths, read_paths(sections, input.settings[kGatherRays]));
            LUCARNE_TRY(publish(input, std::move(paths)));
            finished_ = true;
            return {};
        }
        LUCARNE_ASSIGN(restored_, read_points(sections));
        return {};
    }

    std::vector<Step<const BakeInput>> steps(const BakeInput& from) override {
        std::vector<Step<const BakeInput>> steps;
        const bool is_coarse_first = !restored_ && from.is_shown;
        steps.push_back({"surfels", [this](const BakeInput& input) -> Result<StepResult> {
                             LUCARNE_TRY(start(input));
                             return StepResult::done;
                         }});
        steps.push_back({"parts of discs", [this](const BakeInput&) -> Result<StepResult> {
                             return surfaces_->find_parts() ? StepResult::again : StepResult::done;
                         }});
        steps.push_back(
            {"first points", [this, is_coarse_first](const BakeInput& input) -> Result<StepResult> {
                 if (is_coarse_first)
                     start_coarse(input);
                 else
                     start_whole(input);
                 return StepResult::done;
             }});
        if (is_coarse_first) {
            add_steps(steps);
            steps.push_back({"snapshot", [this](const BakeInput& input) -> Result<StepResult> {
                                 LUCARNE_TRY(publish(input, builder_->take()));
                                 start_whole(input);
                                 return StepResult::done;
                             }});
        }
        add_steps(steps);
        steps.push_back({"snapshot", [this](const BakeInput& input) -> Result<StepResult> {
                             LUCARNE_TRY(publish(input, builder_->take()));
                             finished_ = true;
                             builder_.reset();
                             surfaces_.reset();
                             return StepResult::done;
                         }});
        return steps;
    }

    double share() const override {
        if (finished_) return 1;
        if (!builder_) return 0;
        const double share = is_whole_ ? kCoarseShare + (1 - kCoarseShare) * builder_->share()
                                       : kCoarseShare * builder_->share();
        return std::min(share, 0.999);
    }
    std::shared_ptr<const Bake> snapshot() const override { return bake_; }
    BakeSections save() const override {
        if (finished_) return write_paths(bake_->paths);
        // Coarse paths are soon made again.
        if (is_whole_) return write_points(builder_->points());
        return write_points({.spacing = spacing_, .parts = surfaces_->parts_key()});
    }

 private:
    void add_steps(std::vector<Step<const BakeInput>>& steps) {
        const auto add = [&](std::string_view name, const std::function<bool(PathBuilder&)>& step) {
            steps.push_back({name, [this, step](const BakeInput&) -> Result<StepResult> {
                                 return step(*builder_) ? StepResult::again : StepResult::done;
                             }});
        };
        add("gathering points", &PathBuilder::choose_points);
        add("groups", [](PathBuilder& b) { return b.make_groups(), false; });
        add("larger groups", [](PathBuilder& b) { return b.join_groups(), false; });
        add("links", &PathBuilder::make_links);
        add("entry points", [](PathBuilder& b) { return b.make_entries(), false; });
        add("photon paths", &PathBuilder::make_photons);
    }
    Result<void> start(const BakeInput& input) {
        LUCARNE_ASSIGN(auto tracer, tracing::SurfelTracer::create(input.cut.surfels));
        surfaces_ = std::make_unique<Surfaces>(std::move(tracer));
        spacing_ = spacing_of(input, surfaces_->tracer().surfels());
        return {};
    }
    void start_coarse(const BakeInput& input) {
        builder_.emplace(*surfaces_,
                         PathPlan{{kCoarserSpacing * spacing_.least, kCoarserSpacing * spacing_.most},
                                  kCoarseRays,
                                  kCoarseEntries,
                                  input.settings[kSeed]});
    }
    void start_whole(const BakeInput& input) {
        is_whole_ = true;
        builder_.emplace(*surfaces_, PathPlan{spacing_, input.settings[kGatherRays],
                                              input.settings[kEntryPoints], input.settings[kSeed]});
        if (!restored_) return;
        // A processor with other vector units may have found other parts.
        if (!builder_->restore(std::move(*restored_)))
            log::info("paths: kept points are of other parts of discs, or damaged; they are chosen again");
        restored_.reset();
    }
    /// Makes the snapshot: reads what entry points reflect from the surfels, so that colours and materials
    /// may change without any ray.
    Result<void> publish(const BakeInput& input, LightPaths paths) {
        std::vector<uint32_t> discs;
        for (uint32_t i = 0; i < input.cut.surfels.size(); ++i)
            if (tracing::has_disc(input.cut.surfels[i])) discs.push_back(i);
        auto bake = std::make_shared<PathsBake>();
        const EntryPoints& entries = paths.entries;
        for (size_t i = 0; i < entries.sides.size(); ++i) {
            const Side side = entries.sides[i];
            if (side / 2 >= discs.size()) return rejected("paths", "an entry point is on no surfel");
            const Surfel& s = input.cut.surfels[discs[side / 2]];
            bake->entries.push_back({place_on(s, entries.places[i]), side % 2 ? -s.normal : s.normal,
                                     s.radius, s.albedo, s.material});
        }
        bake->near = PointCells(paths.points, kPixelReach);
        bake->near_blocks = native::point_blocks(paths.points, bake->near.numbers(), kPixelReach);
        bake->far = PointCells(paths.points, kFarReach);
        bake->paths = std::move(paths);
        bake->seed = input.settings[kSeed];
        const Sharing about = find_sharing(*bake);
        if (surfaces_) bake->paths.hidden = find_hidden(*bake, about, surfaces_->tracer());
        bake->sharing = without(about, bake->paths.hidden);
        bake_ = std::move(bake);
        return {};
    }

    std::unique_ptr<Surfaces> surfaces_;
    Spacing spacing_;  ///< asked for
    std::optional<PathBuilder> builder_;
    std::optional<PointChooser::State> restored_;  ///< what was kept of unfinished work
    bool is_whole_ = false, finished_ = false;
    std::shared_ptr<const PathsBake> bake_;
};

constexpr const OptionInfo* kOfBake[] = {&kPointSpacing.info, &kGatherRays.info, &kEntryPoints.info,
                                         &kSeed.info};

}  // namespace

const Precomputes kPathsPrecomputes{
    .make = []() -> std::unique_ptr<Precomputation> { return std::make_unique<PathsPrecomputation>(); },
    .version = 6,
    .options = kOfBake};

}  // namespace lucarne::gi::paths
