#pragma once

#include <string>
#include <string_view>

#include "io/points.h"

namespace lucarne::octree {

/// Appended to the name of an input's attribute that is stored beside one of ours.
inline constexpr std::string_view kForeign = "_in_file";
inline constexpr std::string_view kReplacedNormals = "normal_in_file";

/// Whether an attribute holds normals: three floats or doubles called `normal`.
bool is_normal(const io::Attribute& attribute);

/// The name under which a cache stores an input's attribute. `normal_oct`, `area` and `scan` are ours, and so
/// is `normal` for what is no normal, or where `replace_normals`: these get the suffix, and so do names that
/// have it already. No two names become one.
std::string stored_name(const io::Attribute& attribute, bool replace_normals);
/// The name in the input of what is stored under `name`: stored_name's inverse.
std::string name_in_file(std::string_view name);
/// The name without any suffix where it is one of those that get it, else empty.
std::string_view reserved_name(std::string_view name);

/// Whether the estimated normals of a cache stand in place of the input's own, as `--normals estimate` asks.
bool replaces_normals(const io::Schema& schema);

}  // namespace lucarne::octree
