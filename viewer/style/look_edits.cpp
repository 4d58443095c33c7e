#include "viewer/style/look_edits.h"

#include <set>

#include <fmt/format.h>

#include "gi/registry.h"

namespace lucarne::viewer {

bool is_lit(const ViewModel& model) {
    return !gi::engine_is(model.engine, &gi::EngineInfo::unlit);
}

void switch_light(ViewModel& model) {
    std::string& lit = model.look_tools.lit_engine;
    if (is_lit(model)) {
        lit = model.engine;
        model.engine = gi::engine_with(&gi::EngineInfo::unlit).name;
    } else {
        model.engine = lit.empty() ? gi::default_engine().name : lit;
    }
}

void add_clip_box(ViewModel& model) {
    gi::Clip& clip = model.scene.look.clip;
    if (clip.boxes.size() + clip.planes.size() >= gi::kMostClips) return;
    const glm::dvec3 half(model.scene_size / 8);
    clip.boxes.push_back({model.rig.pivot() - half, model.rig.pivot() + half});
    model.look_tools.show_handles = true;
    model.scene_changed();
}

void add_clip_plane(ViewModel& model) {
    gi::Clip& clip = model.scene.look.clip;
    if (clip.boxes.size() + clip.planes.size() >= gi::kMostClips) return;
    clip.planes.push_back({model.rig.pivot(), model.rig.forward()});
    model.look_tools.show_handles = true;
    model.scene_changed();
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
