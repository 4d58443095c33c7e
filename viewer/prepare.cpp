#include "viewer/prepare.h"

#include <cstring>
#include <utility>
#include <vector>

namespace lucarne::viewer {
namespace {

/// The scene's materials in a part's own terms.
gi::Scene scene_of_part(const gi::Scene& scene, const octree::SourcePart& part) {
    gi::Scene own;
    own.materials = scene.materials;
    for (gi::SceneMaterial& material : own.materials) {
        if (material.scan) *material.scan -= static_cast<int>(part.first_scan);
        if (material.box) {
            material.box->first /= part.scale;
            material.box->second /= part.scale;
        }
    }
    return own;
}

}  // namespace

std::function<octree::NodeData(uint32_t, octree::NodeData&&)> prepare_surfels(
    std::shared_ptr<const octree::NodeSource> source, const gi::Scene& scene) {
    std::vector<gi::Scene> scenes;
    for (const uint32_t root : source->roots()) scenes.push_back(scene_of_part(scene, source->part_of(root)));
    return [source = std::move(source), scenes = std::move(scenes)](uint32_t node, octree::NodeData&& data) {
        const octree::SourcePart part = source->part_of(node);
        const auto surfels = gi::pack_surfels(part.header, source->nodes()[node], data, scenes[part.index]);
        const auto bytes = std::as_bytes(std::span(surfels));
        data.records.assign(bytes.begin(), bytes.end());
        return std::move(data);
    };
}

std::span<const gi::PackedSurfel> prepared_surfels(const octree::NodeData& data) {
    // The vector's memory is aligned for any type, and its bytes are surfels.
    return {reinterpret_cast<const gi::PackedSurfel*>(data.records.data()),
            data.records.size() / sizeof(gi::PackedSurfel)};
}

}  // namespace lucarne::viewer
