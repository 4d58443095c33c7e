#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/points.h"
#include "octree/convert/build.h"
#include "octree/growing/sample.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// The progress of a build.
struct BuildProgress {
    std::string stage;  ///< "normals", for example; empty before the build begins and after it has ended
    double share = 0;   ///< of the stage, 0 to 1
};

/// The state of a build at one moment.
struct BuildState {
    std::shared_ptr<const NodeSource> source;  ///< the newest
    BuildProgress progress;
    bool finished = false;  ///< the source is the cache
    bool stopped = false;   ///< the build ended because of stop(); `error` says no more
    Result<void> error;     ///< why the build ended without a cache; the last source stays
};

struct GrowingOptions {
    BuildOptions build;                ///< leave `inputs` empty: they are passed to open()
    uint64_t sample_points = 400'000;  ///< points of the first source's sample
    Sampling sampling;                 ///< called while the sample is taken; may end it
    double seconds_between = 1.5;      ///< least time between two sources of a running build
    double share_of_time = 0.05;       ///< share of a running build's time that making sources may take
    /// Points of the first source, if it is to come before a sample of `sample_points` can be read, and how
    /// many points may be read for it. Then the sample grows while the build runs: each round doubles it.
    /// 0: the first source is the whole sample.
    uint64_t first_points = 0, first_read = 0;
    /// Points that are kept of the build's first pass, and replace the sample when it has ended (fewer if
    /// they would take over 128 MiB). 0: the sample stays.
    uint64_t read_points = 0;
    /// For how many seconds the build waits, at most, until a picture of such a sample has been made
    /// (seen()): both take all processors, and the picture is waited for. 0: the build goes on at once.
    double patience = 0;
};

/// A scan that is shown at once and converted meanwhile. Its source is first a sample of the whole scan; then
/// finished parts of the build replace the sample piece by piece; at the end it is the cache. Each source is
/// complete and never changes: the renderer switches to the next one between two frames.
class GrowingBuild {
 public:
    using Inputs = std::vector<std::unique_ptr<io::PointSource>>;

    /// Takes the sample. Errors: unreadable inputs, inputs that do not fit together, no points.
    static Result<std::unique_ptr<GrowingBuild>> open(Inputs inputs, GrowingOptions options);
    /// Stops the build at its next step and waits for it. An unfinished cache leaves nothing behind, except
    /// what `build.resume` asks for.
    ~GrowingBuild();
    GrowingBuild(const GrowingBuild&) = delete;
    GrowingBuild& operator=(const GrowingBuild&) = delete;

    /// Starts converting in the background. `changed` is called from the threads of the build, one call at a
    /// time, with every new source and at the end.
    void begin(std::function<void()> changed);
    /// Ends the build at its next step; returns at once. The source stays unchanged.
    void stop();
    /// Blocks until the build has ended.
    void wait();
    /// Says that a picture of this source has been made.
    void seen(const NodeSource* source);

    BuildState state() const;
    /// Returns whether the output is being built by another GrowingBuild or process. Call after this build
    /// has ended.
    bool is_built_elsewhere() const;

 private:
    GrowingBuild();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::octree
