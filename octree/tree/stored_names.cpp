#include "octree/tree/stored_names.h"

#include <algorithm>

namespace lucarne::octree {
namespace {

bool has_normal_shape(const io::Attribute& attribute) {
    return attribute.components == 3 &&
           (attribute.type == io::ScalarType::f32 || attribute.type == io::ScalarType::f64);
}

}  // namespace

bool is_estimate(std::string_view name) {
    return std::ranges::find(kEstimates, name) != kEstimates.end();
}

bool is_normal(const io::Attribute& attribute) {
    return attribute.name == io::names::normal && has_normal_shape(attribute);
}

std::string_view reserved_name(std::string_view name) {
    while (name.ends_with(kForeign)) name.remove_suffix(kForeign.size());
    const bool ours = is_estimate(name) || name == io::names::scan || name == io::names::normal;
    return ours ? name : std::string_view();
}

std::string stored_name(const io::Attribute& attribute, bool replace_normals) {
    const bool stays = reserved_name(attribute.name).empty() || (is_normal(attribute) && !replace_normals);
    return stays ? attribute.name : attribute.name + std::string(kForeign);
}

std::string name_in_file(std::string_view name) {
    if (!reserved_name(name).empty() && name.ends_with(kForeign)) name.remove_suffix(kForeign.size());
    return std::string(name);
}

bool replaces_normals(const io::Schema& schema) {
    const auto* replaced = schema.find(kReplacedNormals);
    return replaced && has_normal_shape(*replaced) && schema.find(io::names::normal_oct);
}

}  // namespace lucarne::octree
