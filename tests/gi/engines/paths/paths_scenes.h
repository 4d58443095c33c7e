// Small scenes for the parts of the engine `paths`, and their precomputation.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/bake/precomputation.h"
#include "gi/bounce_options.h"
#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/options.h"
#include "gi/engines/paths/surfaces.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::paths {

inline BakeInput input_of(std::vector<Surfel> surfels, double spacing = 40, uint32_t rays = 128) {
    BakeInput input;
    glm::vec3 low(1e9f), high(-1e9f);
    for (const Surfel& s : surfels) {
        low = glm::min(low, s.position);
        high = glm::max(high, s.position);
    }
    input.cut.bounds = {low, high};
    input.cut.surfels = std::move(surfels);
    input.settings.set(kPointSpacing, spacing);
    input.settings.set(kGatherRays, rays);
    input.settings.set(kEntryPoints, 50'000);
    return input;
}

/// Takes the steps that are left.
inline std::shared_ptr<const PathsBake> finish(Precomputation& work, const BakeInput& input) {
    StepRunner<const BakeInput> runner;
    if (work.share() < 1) runner.start(work.steps(input));
    const auto done = runner.run(input, StepBudget{});
    EXPECT_TRUE(done) << done.error().line();
    return std::dynamic_pointer_cast<const PathsBake>(work.snapshot());
}

inline std::shared_ptr<const PathsBake> bake_of(const BakeInput& input) {
    const auto work = kPathsPrecomputes.make();
    return finish(*work, input);
}

/// Returns the tracer of these surfels.
inline std::unique_ptr<tracing::SurfelTracer> tracer_of(std::vector<Surfel> surfels) {
    auto made = tracing::SurfelTracer::create(std::move(surfels));
    EXPECT_TRUE(made) << made.error().line();
    return std::move(*made);
}

/// Returns the surfaces of these surfels.
inline Surfaces surfaces_of(std::vector<Surfel> surfels) {
    Surfaces surfaces(tracer_of(std::move(surfels)));
    while (surfaces.find_parts()) continue;
    return surfaces;
}

}  // namespace lucarne::gi::paths
