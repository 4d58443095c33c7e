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

/// How far a build is.
struct BuildProgress {
    std::string stage;  ///< "normals"; empty before the build begins and after it ended
    double share = 0;   ///< of the stage, 0 to 1
};

/// All that there is to know of a build at one moment.
struct BuildState {
    std::shared_ptr<const NodeSource> source;  ///< the newest
    BuildProgress progress;
    bool finished = false;  ///< the source is the cache
    bool stopped = false;   ///< the build has ended because of stop(): `error` says no more than that
    Result<void> error;     ///< why the build ended without a cache; the last source stays
};

struct GrowingOptions {
    BuildOptions build;                ///< inputs: empty, they are given on their own
    uint64_t sample_points = 400'000;  ///< of the first picture
    Sampling sampling;                 ///< told while the sample is taken; may end it
    double seconds_between = 1.5;      ///< at the least, between two sources that a running build gives
};

/// A scan that is shown at once and converted meanwhile. Its source is first a sample of the whole, then what
/// the build has finished in place of the sample, piece by piece, at the end the cache. Each source is whole
/// in itself and never changes: whoever draws takes the next one between two pictures.
class GrowingBuild {
 public:
    using Inputs = std::vector<std::unique_ptr<io::PointSource>>;

    /// Takes the sample. Errors: unreadable inputs, inputs that do not fit together, no points.
    static Result<std::unique_ptr<GrowingBuild>> open(Inputs inputs, GrowingOptions options);
    /// Stops the build at its next step and waits for it. A cache that is not finished leaves nothing, but
    /// for what `build.resume` asks for.
    ~GrowingBuild();
    GrowingBuild(const GrowingBuild&) = delete;
    GrowingBuild& operator=(const GrowingBuild&) = delete;

    /// Starts converting in the background; `changed` is called from there with every new source and at the
    /// end.
    void begin(std::function<void()> changed);
    /// Ends the build at its next step; returns at once. The source stays what it is.
    void stop();
    /// Blocks until the build has ended.
    void wait();

    BuildState state() const;

 private:
    GrowingBuild();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::octree
