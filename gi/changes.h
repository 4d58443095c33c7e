// What differs between two frames of one engine, so that engines need not compare inputs themselves.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "gi/frame.h"
#include "gi/surfels/cut_nodes.h"

namespace lucarne::gi {

/// One number for each input of a frame. For one engine, equal numbers mean equal inputs.
struct SceneRevisions {
    uint64_t settings = 0, lights = 0, materials = 0, environment = 0, bounds = 0;
    bool operator==(const SceneRevisions&) const = default;
};

/// Likewise for the cuts that light is computed from.
struct LightCutRevisions {
    uint64_t light = 0;
    std::vector<uint64_t> light_views;  ///< one a light
    bool operator==(const LightCutRevisions&) const = default;
};

/// What an engine is told before each frame. Results that were computed for equal revisions are still right;
/// the nodes are for engines that keep something for each node. For an engine's first frame all nodes are
/// added.
struct Changes {
    SceneRevisions scene;
    LightCutRevisions light_cuts;
    uint64_t view_cut = 0;
    uint64_t look = 0;  ///< background and the options of the engine without light
    NodeChanges view_nodes, light_nodes;
};

/// Remembers the inputs of the last frame and numbers those that change.
class ChangeTracker {
 public:
    Changes next(const Frame& frame);

 private:
    template <class Input>
    struct Tracked {
        Input input{};
        uint64_t revision = 0;
        /// The revision of `now`, a new one where it differs from the last input.
        uint64_t update(const Input& now);
    };
    struct Look {
        glm::vec3 background{0.0f};
        Unlit unlit;
        bool operator==(const Look&) const = default;
    };

    Tracked<EngineSettings> settings_;
    Tracked<std::vector<Light>> lights_;
    Tracked<std::vector<Material>> materials_;
    Tracked<std::shared_ptr<const Environment>> environment_;
    Tracked<Bounds> bounds_;
    Tracked<Look> look_;
    std::vector<CutNode> view_nodes_, light_nodes_;
};

}  // namespace lucarne::gi
