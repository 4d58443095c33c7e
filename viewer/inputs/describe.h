#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "io/formats/scan.h"

// What `info` and `convert` say of scans, as JSON.
namespace lucarne::viewer {

nlohmann::ordered_json vector_json(const glm::dvec3& v);
nlohmann::ordered_json attributes_json(const io::Schema& schema);

/// Path, format, coordinate system and unit, stations, what was left out; with `contents` the points and
/// their bounds as they were read; of a mesh that is sampled without `contents` its own box and about how
/// many points it becomes. The box that a header states is `stated_min` and `stated_max`. What a file of
/// several scans says of each, and its images; of a mesh. `unit_given`: by the user.
nlohmann::ordered_json scan_json(const io::ScanInfo& info, const io::Schema& schema,
                                 const io::Contents* contents);

nlohmann::ordered_json losses_json(const io::Losses& losses);
/// "12 points whose state is invalid, 3 images, which are listed but not read".
std::string losses_text(const io::Losses& losses);

}  // namespace lucarne::viewer
