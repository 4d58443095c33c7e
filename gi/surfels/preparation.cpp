#include "gi/surfels/preparation.h"

#include <utility>
#include <vector>

namespace lucarne::gi {
namespace {

/// Returns the scene with materials for one part: boxes and scans in the part's own terms.
Scene scene_of_part(const Scene& scene, const octree::SourcePart& part) {
    Scene own;
    own.materials = scene.materials;
    own.look = scene.look;
    own.albedo = scene.albedo;
    if (own.look.range && own.look.colour == ColourBy::elevation) {
        own.look.range->low /= part.scale;
        own.look.range->high /= part.scale;
    }
    for (SceneMaterial& material : own.materials) {
        if (material.scan) *material.scan -= static_cast<int>(part.first_scan);
        if (material.box) {
            material.box->first /= part.scale;
            material.box->second /= part.scale;
        }
    }
    return own;
}

}  // namespace

SurfelPreparation::SurfelPreparation(std::shared_ptr<const octree::NodeSource> source, const Scene& scene)
    : source_(std::move(source)) {
    set_scene(scene);
}

void SurfelPreparation::set_scene(const Scene& scene, const BakedLight* baked) {
    auto parts = std::make_shared<std::vector<OfPart>>();
    for (const uint32_t root : source_->roots()) {
        const octree::SourcePart part = source_->part_of(root);
        OfPart own{scene_of_part(scene, part), std::nullopt};
        if (baked) own.baked = baked->in_unit(part.scale);
        parts->push_back(std::move(own));
    }
    const std::lock_guard lock(mutex_);
    parts_ = std::move(parts);
}

std::shared_ptr<const std::vector<SurfelPreparation::OfPart>> SurfelPreparation::parts() const {
    const std::lock_guard lock(mutex_);
    return parts_;
}

PackedNode SurfelPreparation::pack(uint32_t node, const octree::NodeData& data) const {
    const auto all = parts();
    const octree::SourcePart part = source_->part_of(node);
    const OfPart& own = (*all)[part.index];
    return pack_surfels(part.header, source_->nodes()[node], data, own.scene, part.first_scan,
                        own.baked ? &*own.baked : nullptr);
}

PackedNode SurfelPreparation::pack(const octree::Filling& filling, uint32_t node) const {
    const auto all = parts();
    const OfPart& own = (*all)[filling.part];
    return pack_surfels(filling.header, filling.nodes[node], filling.records[node], own.scene, 0,
                        own.baked ? &*own.baked : nullptr);
}

}  // namespace lucarne::gi
