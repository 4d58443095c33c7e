#include "gi/engines/paths/bake.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "gi/bounce_options.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/paths/store.h"

namespace lucarne::gi::paths {
namespace {

/// R- as a share of R+, and at least so many radii of a mean surfel.
constexpr float kLeastShare = 0.125f, kLeastRadii = 4;
/// Of the smallest cells, in R-: between gathering points light is interpolated anyway.
constexpr float kLeastCell = 1;
/// Of the cells from all over which links start, in R+: light of further bounces is smooth.
constexpr float kLinkReach = 0.5f;
constexpr size_t kPathsAtOnce = 131072;
/// Shares of the work: gathering points, links, photons.
constexpr double kPointsShare = 0.75, kLinksShare = 0.2;

Spacing spacing_of(const BakeInput& input, std::span<const Surfel> surfels) {
    const float diagonal = glm::distance(input.cut.bounds.min, input.cut.bounds.max);
    double radius = 0;
    for (const Surfel& s : surfels) radius += s.radius / static_cast<double>(surfels.size());
    const float most = std::max(static_cast<float>(input.settings[kPointSpacing]) * 1e-3f * diagonal, 1e-6f);
    const float least = std::max(kLeastShare * most, kLeastRadii * static_cast<float>(radius));
    return {least, std::max(least, most)};
}

/// The steps: gathering points with their rays, groups, links, photon paths.
class PathsPrecomputation final : public Precomputation {
 public:
    Result<void> restore(const BakeInput& input, const BakeSections& sections) override {
        if (sections.contains("rays")) {
            LUCARNE_ASSIGN(LightPaths paths, read_paths(sections, input.settings[kGatherRays]));
            return publish(input, std::move(paths));
        }
        LUCARNE_ASSIGN(PointChooser::State state, read_points(sections));
        LUCARNE_TRY(start(input));
        if (!chooser_->restore(std::move(state))) return rejected("paths", "the points are damaged");
        return {};
    }

    std::vector<Step<const BakeInput>> steps(const BakeInput&) override {
        std::vector<Step<const BakeInput>> steps;
        const auto add = [&](std::string_view name,
                             StepResult (PathsPrecomputation::*step)(const BakeInput&)) {
            steps.push_back({name, [this, step](const BakeInput& input) -> Result<StepResult> {
                                 if (!tracer_) LUCARNE_TRY(start(input));
                                 return (this->*step)(input);
                             }});
        };
        add("gathering points", &PathsPrecomputation::choose_points);
        add("groups", &PathsPrecomputation::make_groups);
        add("larger groups", &PathsPrecomputation::join_groups);
        add("links", &PathsPrecomputation::make_links);
        add("entry points", &PathsPrecomputation::make_entries);
        add("photon paths", &PathsPrecomputation::make_photons);
        steps.push_back({"snapshot", [this](const BakeInput& input) -> Result<StepResult> {
                             LUCARNE_TRY(publish(input, std::move(work_)));
                             links_.reset();
                             builder_.reset();
                             chooser_.reset();
                             tracer_.reset();
                             return StepResult::done;
                         }});
        return steps;
    }

    double share() const override {
        if (bake_) return 1;
        if (!chooser_) return builder_ ? kPointsShare : 0;
        double share = kPointsShare * std::min(chooser_->share(), 0.999);
        if (!builder_) return share;
        share = kPointsShare;
        if (links_) share += kLinksShare * links_->share();
        if (!work_.entries.sides.empty())
            share += (1 - kPointsShare - kLinksShare) * static_cast<double>(next_path_) /
                     static_cast<double>(work_.entries.sides.size() + 1);
        return std::min(share, 0.999);
    }
    std::shared_ptr<const Bake> snapshot() const override { return bake_; }
    BakeSections save() const override {
        if (bake_) return write_paths(bake_->paths);
        return chooser_ ? write_points(chooser_->state()) : BakeSections{};
    }

 private:
    Result<void> start(const BakeInput& input) {
        LUCARNE_ASSIGN(tracer_, tracing::SurfelTracer::create(input.cut.surfels));
        chooser_.emplace(*tracer_, spacing_of(input, tracer_->surfels()), input.settings[kGatherRays],
                         input.settings[kSeed]);
        return {};
    }
    StepResult choose_points(const BakeInput&) {
        return chooser_->advance() ? StepResult::again : StepResult::done;
    }
    StepResult make_groups(const BakeInput&) {
        const PointChooser::State& state = chooser_->state();
        builder_.emplace(tracer_->surfels(), state.hits, kLeastCell * state.spacing.least);
        return StepResult::done;
    }
    StepResult join_groups(const BakeInput& input) {
        const PointChooser::State& state = chooser_->state();
        const std::span<const uint32_t> leaf_of = builder_->leaf_of();
        const uint32_t rays = input.settings[kGatherRays];
        for (size_t i = 0; i < state.hits.size(); ++i)
            if (state.hits[i].side != kNone)
                builder_->connect(leaf_of[state.points[i / rays].side], leaf_of[state.hits[i].side]);
        work_.groups = builder_->join();
        links_.emplace(*tracer_, *builder_, work_.groups, kLinkReach * state.spacing.most,
                       input.settings[kSeed]);
        work_.rays_a_point = rays;
        for (const RayHit& hit : state.hits) {
            work_.rays.push_back(hit.side == kNone ? kNone
                                                   : work_.groups.fitting(leaf_of[hit.side], hit.width));
            if (work_.rays.back() != kNone) links_->ask(work_.rays.back());
        }
        return StepResult::done;
    }
    StepResult make_links(const BakeInput&) {
        return links_->advance() ? StepResult::again : StepResult::done;
    }
    StepResult make_entries(const BakeInput& input) {
        work_.entries = choose_entries(tracer_->surfels(), *builder_, work_.groups.area, links_->used(),
                                       input.settings[kEntryPoints]);
        work_.links = links_->take();
        work_.photons.assign(work_.entries.sides.size() * (kVertices - 1), kNone);
        return StepResult::done;
    }
    StepResult make_photons(const BakeInput& input) {
        const size_t count = work_.entries.sides.size(), last = std::min(count, next_path_ + kPathsAtOnce);
        trace_photons(*tracer_, builder_->leaf_of(), work_.entries, next_path_, last, input.settings[kSeed],
                      std::span(work_.photons).subspan(next_path_ * (kVertices - 1)));
        next_path_ = last;
        if (next_path_ < count) return StepResult::again;
        work_.points = chooser_->state().points;
        work_.groups.leaf_of.clear();
        return StepResult::done;
    }
    /// Makes the snapshot: reads what entry points reflect from the surfels, so that colours and materials
    /// may change without any ray.
    Result<void> publish(const BakeInput& input, LightPaths paths) {
        std::vector<uint32_t> discs;
        for (uint32_t i = 0; i < input.cut.surfels.size(); ++i)
            if (tracing::has_disc(input.cut.surfels[i])) discs.push_back(i);
        auto bake = std::make_shared<PathsBake>();
        for (const Side side : paths.entries.sides) {
            if (side / 2 >= discs.size()) return rejected("paths", "an entry point is on no surfel");
            const Surfel& s = input.cut.surfels[discs[side / 2]];
            bake->entries.push_back(
                {s.position, side % 2 ? -s.normal : s.normal, s.radius, s.albedo, s.material});
        }
        bake->near = PointCells(paths.points, kPixelReach);
        bake->far = PointCells(paths.points, kFarReach);
        bake->paths = std::move(paths);
        bake_ = std::move(bake);
        return {};
    }

    std::unique_ptr<tracing::SurfelTracer> tracer_;
    std::optional<PointChooser> chooser_;
    std::optional<GroupBuilder> builder_;
    std::optional<LinkBuilder> links_;
    size_t next_path_ = 0;
    LightPaths work_;
    std::shared_ptr<const PathsBake> bake_;
};

constexpr const OptionInfo* kOfBake[] = {&kPointSpacing.info, &kGatherRays.info, &kEntryPoints.info,
                                         &kSeed.info};

}  // namespace

const Precomputes kPathsPrecomputes{
    .make = []() -> std::unique_ptr<Precomputation> { return std::make_unique<PathsPrecomputation>(); },
    .options = kOfBake};

}  // namespace lucarne::gi::paths
