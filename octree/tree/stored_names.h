#pragma once

#include <array>
#include <string>
#include <string_view>

#include "io/points.h"

namespace lucarne::octree {

/// Suffix of an input's attribute whose name is reserved for one of the cache's own attributes.
inline constexpr std::string_view kForeign = "_in_file";
inline constexpr std::string_view kReplacedNormals = "normal_in_file";

/// The attributes that a build adds to what its inputs have.
inline constexpr std::array kEstimates = {io::names::normal_oct, io::names::area, io::names::edge_line,
                                          io::names::color_change};
bool is_estimate(std::string_view name);

/// Whether an attribute holds normals: three floats or doubles called `normal`.
bool is_normal(const io::Attribute& attribute);

/// Returns the name under which a cache stores an input's attribute. Reserved are kEstimates and `scan`;
/// `normal` is reserved too if the attribute is not a normal or if `replace_normals` is set. Reserved names
/// get the suffix, and so do those that have it already, so that different names stay different.
std::string stored_name(const io::Attribute& attribute, bool replace_normals);
/// Returns the input's name of the attribute stored under `name`: the inverse of stored_name.
std::string name_in_file(std::string_view name);
/// Returns the name without any suffix if it is one of those that can get it, else an empty one.
std::string_view reserved_name(std::string_view name);

/// Whether a cache has estimated normals in place of the input's own, as `--normals estimate` asks.
bool replaces_normals(const io::Schema& schema);

}  // namespace lucarne::octree
