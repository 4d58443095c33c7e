#include "viewer/style/look_edits.h"

#include <set>

#include <fmt/format.h>

#include "gi/registry.h"

namespace lucarne::viewer {

bool is_lit(const Styling& model) {
    return !gi::engine_is(model.view.method.engine, &gi::EngineInfo::unlit);
}

void switch_light(const Styling& model) {
    std::string& lit = model.look.lit_engine;
    if (is_lit(model)) {
        lit = model.view.method.engine;
        model.view.method.engine = gi::engine_with(&gi::EngineInfo::unlit).name;
    } else {
        model.view.method.engine = lit.empty() ? gi::default_engine().name : lit;
    }
}

void add_clip_box(const Styling& model) {
    gi::Clip& clip = model.view.scene.look.clip;
    if (clip.boxes.size() + clip.planes.size() >= gi::kMostClips) return;
    const glm::dvec3 half(model.view.scene_size / 8);
    clip.boxes.push_back({model.view.rig.pivot() - half, model.view.rig.pivot() + half});
    model.look.show_handles = true;
    model.view.scene_changed();
}

void add_clip_plane(const Styling& model) {
    gi::Clip& clip = model.view.scene.look.clip;
    if (clip.boxes.size() + clip.planes.size() >= gi::kMostClips) return;
    clip.planes.push_back({model.view.rig.pivot(), model.view.rig.forward()});
    model.look.show_handles = true;
    model.view.scene_changed();
}

std::vector<std::string> attribute_names(const octree::NodeSource& source) {
    std::set<std::string> names;
    for (const uint32_t root : source.roots())
        for (const io::Attribute& attribute : source.part_of(root).header.schema.attributes) {
            names.insert(attribute.name);
            for (uint32_t i = 1; i < std::min(attribute.components, 16u); ++i)
                names.insert(fmt::format("{}.{}", attribute.name, i));
        }
    return {names.begin(), names.end()};
}

}  // namespace lucarne::viewer
