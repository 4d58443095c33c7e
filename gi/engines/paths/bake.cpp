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
/// The share of the rays between gathering points in the work on paths.
constexpr double kHiddenShare = 0.03;

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
            LUCARNE_TRY(make_bake(input, std::move(paths)));
            while (sharing_->advance()) continue;
            about_ = sharing_->take();
            publish();
            finished_ = true;
            return {};
        }
        LUCARNE_ASSIGN(restored_, read_points(sections));
        return {};
    }

    std::vector<Step<const BakeInput>> steps(const BakeInput&) override {
        std::vector<Step<const BakeInput>> steps;
        steps.push_back({"surfels", [this](const BakeInput& input) -> Result<StepResult> {
                             LUCARNE_TRY(start(input));
                             return StepResult::done;
                         }});
        steps.push_back({"parts of discs", [this](const BakeInput&) -> Result<StepResult> {
                             return surfaces_->find_parts() ? StepResult::again : StepResult::done;
                         }});
        steps.push_back({"first points", [this](const BakeInput& input) -> Result<StepResult> {
                             begin_paths(input);
                             return StepResult::done;
                         }});
        add_steps(steps, true);
        steps.push_back({"coarse paths", [this](const BakeInput& input) -> Result<StepResult> {
                             if (!is_coarse_) return StepResult::skipped;
                             publish();
                             begin_whole(input);
                             return StepResult::done;
                         }});
        add_steps(steps, false);
        steps.push_back({"paths", [this](const BakeInput&) -> Result<StepResult> {
                             publish();
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
        const double paths =
            (1 - kHiddenShare) * builder_->share() + kHiddenShare * (hidden_ ? hidden_->share() : 0);
        const double share = is_coarse_ ? kCoarseShare * paths : kCoarseShare + (1 - kCoarseShare) * paths;
        return std::min(share, 0.999);
    }
    std::shared_ptr<const Bake> snapshot() const override { return bake_; }
    BakeSections save() const override {
        if (finished_) return write_paths(bake_->paths);
        // Coarse paths are soon made again.
        if (!is_coarse_) return write_points(builder_->points());
        return write_points({.spacing = spacing_, .parts = surfaces_->parts_key()});
    }

 private:
    /// Adds the steps to coarse paths, which are skipped if there are to be none, or to all paths.
    void add_steps(std::vector<Step<const BakeInput>>& steps, bool coarse) {
        const auto add = [&](std::string_view name, const std::function<bool()>& step) {
            steps.push_back({name, [this, step, coarse](const BakeInput&) -> Result<StepResult> {
                                 if (coarse && !is_coarse_) return StepResult::skipped;
                                 return step() ? StepResult::again : StepResult::done;
                             }});
        };
        add("gathering points", [this] { return builder_->choose_points(); });
        add("groups", [this] { return builder_->make_groups(); });
        add("larger groups", [this] { return builder_->join_groups(); });
        add("links", [this] { return builder_->make_links(); });
        add("entry points", [this] { return builder_->make_entries(); });
        add("photon paths", [this] { return builder_->make_photons(); });
        steps.push_back({"snapshot", [this, coarse](const BakeInput& input) -> Result<StepResult> {
                             if (coarse && !is_coarse_) return StepResult::skipped;
                             LUCARNE_TRY(make_bake(input, builder_->take()));
                             return StepResult::done;
                         }});
        add("neighbours", [this] {
            if (sharing_->advance()) return true;
            about_ = sharing_->take();
            hidden_.emplace(*next_, about_, surfaces_->tracer());
            return false;
        });
        add("hidden neighbours", [this] { return hidden_->advance(); });
    }
    Result<void> start(const BakeInput& input) {
        LUCARNE_ASSIGN(auto tracer, tracing::SurfelTracer::create(input.cut.surfels));
        surfaces_ = std::make_unique<Surfaces>(std::move(tracer));
        spacing_ = spacing_of(input, surfaces_->tracer().surfels());
        return {};
    }
    /// Continues with the gathering points that were kept, or begins with coarse paths if anything shows
    /// them.
    void begin_paths(const BakeInput& input) {
        auto kept = std::exchange(restored_, std::nullopt);
        if (kept && kept->next > 0) {
            begin_whole(input);
            if (builder_->restore(std::move(*kept))) return;
            // A processor with other vector units may have found other parts.
            log::info("paths: kept points are of other parts of discs, or damaged; they are chosen again");
        }
        input.is_shown ? begin_coarse(input) : begin_whole(input);
    }
    void begin_coarse(const BakeInput& input) {
        is_coarse_ = true;
        builder_.emplace(*surfaces_,
                         PathPlan{{kCoarserSpacing * spacing_.least, kCoarserSpacing * spacing_.most},
                                  kCoarseRays,
                                  kCoarseEntries,
                                  input.settings[kSeed],
                                  input.lighting_region});
    }
    void begin_whole(const BakeInput& input) {
        is_coarse_ = false;
        builder_.emplace(*surfaces_,
                         PathPlan{spacing_, input.settings[kGatherRays], input.settings[kEntryPoints],
                                  input.settings[kSeed], input.lighting_region});
    }
    /// Makes the next snapshot up to what points share: reads what entry points reflect from the surfels, so
    /// that colours and materials may change without any ray.
    Result<void> make_bake(const BakeInput& input, LightPaths paths) {
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
        bake->planes = paths.groups.find_planes();
        bake->paths = std::move(paths);
        bake->seed = input.settings[kSeed];
        next_ = std::move(bake);
        sharing_.emplace(*next_);
        return {};
    }
    /// Publishes the next snapshot: points share light with those they see.
    void publish() {
        if (hidden_) next_->paths.hidden = hidden_->take();
        hidden_.reset();
        sharing_.reset();
        next_->sharing = without(std::exchange(about_, {}), next_->paths.hidden);
        bake_ = std::exchange(next_, nullptr);
    }

    std::unique_ptr<Surfaces> surfaces_;
    Spacing spacing_;  ///< asked for
    std::optional<PathBuilder> builder_;
    std::optional<PointChooser::State> restored_;  ///< what was kept of unfinished work
    bool is_coarse_ = false;                       ///< coarse paths are being made
    bool finished_ = false;
    std::shared_ptr<PathsBake> next_;  ///< the next snapshot
    std::optional<SharingFinder> sharing_;
    Sharing about_;  ///< what its points would share if nothing hid them from each other
    std::optional<HiddenFinder> hidden_;
    std::shared_ptr<const PathsBake> bake_;
};

/// About what MEASURED.md says of naves. Large scans have few gathering points for their surfels.
BakeCost cost_of(const EngineSettings& settings, uint64_t surfels) {
    constexpr double kSeconds = 35e-6, kSecondsARay = .09e-6;                   // a surfel
    constexpr double kMemory = 500, kMemoryARay = 1;                            // bytes
    constexpr double kFile = 34, kMostOfFile = 100, kFileOfPointsARay = 6.7e4;  // bytes; of all points
    const auto count = static_cast<double>(surfels), rays = static_cast<double>(settings[kGatherRays]);
    const double file = std::min(kFile * count + kFileOfPointsARay * rays, kMostOfFile * count);
    return {.cpu_seconds = count * (kSeconds + kSecondsARay * rays),
            .memory_bytes = static_cast<uint64_t>(count * (kMemory + kMemoryARay * rays)),
            .file_bytes = static_cast<uint64_t>(file)};
}

constexpr const OptionInfo* kOfBake[] = {&kPointSpacing.info, &kGatherRays.info, &kEntryPoints.info,
                                         &kSeed.info};

}  // namespace

const Precomputes kPathsPrecomputes{
    .make = []() -> std::unique_ptr<Precomputation> { return std::make_unique<PathsPrecomputation>(); },
    .version = 9,
    .lighting_region = true,
    .options = kOfBake,
    .cost = &cost_of};

}  // namespace lucarne::gi::paths
