// Surfels built by hand, loaded to a device through the same pool, cut and G-buffer as those of a scan.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/registry.h"
#include "gi/shared/surfel_code.h"
#include "octree/tree/source.h"
#include "tests/gi/engines/even_order.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/test_lights.h"
#include "tests/gi/engines/test_settings.h"

namespace lucarne::gi::scenes {

/// One octree node with all surfels of a scene, which all have the same area. The classification holds the
/// material.
class OneNode final : public octree::NodeSource {
 public:
    explicit OneNode(std::vector<Surfel> surfels) {
        order_evenly(surfels);
        auto& schema = header_.schema;
        schema.position = io::PositionType::f64;
        schema.add(std::string(io::names::normal), io::ScalarType::f32, 3);
        schema.add(std::string(io::names::color), io::ScalarType::u16, 3);
        schema.add(std::string(io::names::classification), io::ScalarType::u8);
        glm::vec3 least(1e30f), most(-1e30f);
        for (const Surfel& s : surfels) {
            least = glm::min(least, s.position);
            most = glm::max(most, s.position);
        }
        if (surfels.empty()) least = most = glm::vec3(0.0f);
        header_.min = least;
        header_.max = most;
        const glm::vec3 extent = most - least;
        header_.root = {glm::dvec3(least) - 0.001, std::max({extent.x, extent.y, extent.z}) + 0.002};
        header_.points = surfels.size();
        if (surfels.empty()) return;
        octree::NodeInfo node;
        node.count = static_cast<uint32_t>(surfels.size());
        node.subtree_count = node.count;
        // Surfels store no share of their own, so that the floor decides: an even pattern.
        for (uint32_t step = 0; step < octree::kPrefixSteps; ++step)
            node.area_floor[step] = surfels[0].area * static_cast<float>(1u << step);
        nodes_.push_back(node);
        data_.count = node.count;
        for (const Surfel& s : surfels) append(s);
    }

    const octree::SourceHeader& header() const override { return header_; }
    octree::NodeTable nodes() const override { return nodes_; }
    Result<octree::NodeData> load(uint32_t) const override { return data_; }

 private:
    void append(const Surfel& s) {
        const size_t at = data_.records.size();
        data_.records.resize(at + header_.schema.stride);
        std::byte* record = data_.records.data() + at;
        for (int i = 0; i < 3; ++i) {
            io::store<double>(record + 8 * i, s.position[i]);
            io::store<float>(record + 24 + 4 * i, s.normal[i]);
            io::store<uint16_t>(record + 36 + 2 * i,
                                static_cast<uint16_t>(std::lround(65535 * linear_to_srgb(s.albedo[i]))));
        }
        io::store<uint8_t>(record + 42, static_cast<uint8_t>(s.material));
    }

    octree::SourceHeader header_;
    std::vector<octree::NodeInfo> nodes_;
    octree::NodeData data_;
};

struct AnalyticScene {
    std::vector<Surfel> surfels;
    std::vector<Light> lights;
    std::vector<Material> materials;  ///< [0] is the default
    CameraView camera;
    EngineSettings settings = test_settings();
    std::shared_ptr<const Environment> environment = nullptr;
    bool moving = false;
    /// Number of materials of the scene for which the surfels were packed, if it had more.
    size_t packed_materials = 0;
    /// What the engine has computed in advance, for pictures of the same surfels (Lit::bake); null: it
    /// computes it.
    std::shared_ptr<const Bake> bake = nullptr;
};

/// Returns the camera of a square picture at `eye` that looks at `target`; `tangent` is that of half the
/// field of view.
inline CameraView look(const glm::vec3& eye, const glm::vec3& target, float tangent, uint32_t size) {
    return gi::look(eye, target, size, size, 2 * std::atan(tangent));
}

/// Renders a scene with an engine as the viewer would: every cut is the whole scene.
inline Result<Lit> render(Device& device, std::string_view engine_name, const AnalyticScene& scene,
                          uint64_t index = 0) {
    const OneNode source(scene.surfels);
    Scene assignments;
    assignments.materials.resize(std::max({scene.materials.size(), scene.packed_materials, size_t{1}}));
    for (size_t i = 1; i < assignments.materials.size(); ++i)
        assignments.materials[i].classification = static_cast<int>(i);
    LUCARNE_ASSIGN(SurfelPool pool, SurfelPool::create(device, static_cast<uint32_t>(scene.surfels.size())));
    std::vector<CutEntry> entries;
    if (!source.nodes().empty()) {
        LUCARNE_ASSIGN(const auto data, source.load(0));
        LUCARNE_ASSIGN(const bool fits,
                       pool.load(0, pack_surfels(source.header(), source.nodes()[0], data, assignments)));
        EXPECT_TRUE(fits);
        entries.push_back({0, source.nodes()[0].count});
    }
    DeviceCut cut;
    LUCARNE_TRY(pool.make_cut(device, source, entries, glm::dvec3(0.0), cut));
    LUCARNE_ASSIGN(const auto engine, make_engine(engine_name));
    const Bounds bounds{glm::vec3(source.header().min), glm::vec3(source.header().max)};
    LitOptions options;
    options.lights = scene.lights;
    if (!scene.materials.empty()) options.materials = scene.materials;
    options.settings = scene.settings;
    options.index = index;
    options.environment = scene.environment;
    options.bake = scene.bake;
    options.moving = scene.moving;
    return draw_frame(device, *engine, pool, cut, scene.camera, bounds, options);
}

/// Returns the point that a texel shows.
inline glm::vec3 position_of(const CameraView& camera, const std::vector<GBufferTexel>& texels,
                             size_t pixel) {
    return texel_position(camera, glm::vec2(pixel % camera.width, pixel / camera.width), texels[pixel]);
}

}  // namespace lucarne::gi::scenes
