#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/bake/bake_job.h"
#include "gi/scene/scene.h"
#include "io/core/progress.h"
#include "viewer/frame/presets.h"
#include "viewer/frame/surfel_stream.h"

namespace lucarne::viewer {

/// What a precomputation is made for. The references must hold during the call they are passed to.
struct BakeSubject {
    const gi::EngineInfo& engine;
    const std::shared_ptr<const octree::NodeSource>& source;
    const std::array<glm::dvec3, 2>& bounds;  ///< robust bounds of the source, world units
    const SurfelStream& surfels;
    const gi::Scene& scene;
    const gi::EngineSettings& settings;
    uint64_t points = 0;   ///< of the cut
    bool is_shown = true;  ///< while it is made; a precomputation that runs already goes on as it does
    uint64_t again = 0;    ///< FrameRequest::prepares_again
};

/// Returns the file of an engine's finished precomputation for a scan that has not been written since; empty:
/// none is kept. It may have been made with other options or for other points: then pictures begin it again.
std::filesystem::path kept_bake(const gi::EngineInfo& engine, const octree::NodeSource& source);

/// Runs the precomputation of the engine that draws pictures, and starts it again when an input changes.
class EngineBake {
 public:
    /// `published` is called when there is news: on another thread, and by update() with an empty status when
    /// another one begins or none runs any more.
    void on_news(std::function<void(const gi::BakeJob::Status&)> published) {
        published_ = std::move(published);
    }
    /// Starts what the engine precomputes, unless that runs or has ended. One that has failed is started
    /// again when it is asked for `again`. An engine that precomputes nothing ends what runs.
    void update(const BakeSubject& subject);
    /// Ends what runs. It tells no news any more.
    void end();
    /// Waits until it has ended or `stop` is true. Errors: it failed.
    Result<void> wait(const std::atomic<bool>* stop, Progress* progress) const;

    bool running() const { return job_ != nullptr; }
    /// The engine that it is made for; null: nothing is made.
    const gi::EngineInfo* engine() const { return job_ ? inputs_.engine : nullptr; }
    gi::BakeJob::Status status() const { return job_ ? job_->status() : gi::BakeJob::Status{}; }
    /// Meaning of the coordinates of its surfels.
    const gi::LocalFrame& frame() const { return frame_; }

 private:
    /// All inputs, for comparisons. Those that the engine does not depend on have always the same value.
    struct Inputs {
        const gi::EngineInfo* engine = nullptr;
        std::shared_ptr<const octree::NodeSource> source;
        uint64_t packing = 0, points = 0;
        bool open_holes = false;
        gi::Clip clip;
        std::vector<gi::SceneLight> lights;
        std::vector<gi::SceneMaterial> materials;
        double albedo_scale = 1;
        std::shared_ptr<const gi::Environment> environment;
        std::optional<gi::SceneBox> lighting_region;
        std::vector<gi::OptionValue> options;
        bool operator==(const Inputs&) const = default;
    };
    static Inputs inputs_of(const BakeSubject& subject);

    std::function<void(const gi::BakeJob::Status&)> published_ = [](const gi::BakeJob::Status&) {};
    Inputs inputs_;
    gi::LocalFrame frame_;
    std::unique_ptr<gi::BakeJob> job_;
    uint64_t again_ = 0;  ///< BakeSubject::again of the last update
};

}  // namespace lucarne::viewer
