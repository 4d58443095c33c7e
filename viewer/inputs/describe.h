#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "io/formats/scan.h"

// What `info` and `convert` report about scans, as JSON.
namespace lucarne::viewer {

nlohmann::ordered_json vector_json(const glm::dvec3& v);
nlohmann::ordered_json attributes_json(const io::Schema& schema);

/// Describes a scan: path, format, coordinate system and unit, stations, and what was left out. With
/// `contents`: also the points and their bounds as they were read. For a sampled mesh without `contents`: its
/// bounding box and the approximate number of points. `stated_min` and `stated_max` are the box that the
/// header states. Also describes each scan of a file with several scans, its images, and a mesh's properties.
nlohmann::ordered_json scan_json(const io::ScanInfo& info, const io::Schema& schema,
                                 const io::Contents* contents);

nlohmann::ordered_json losses_json(const io::Losses& losses);
/// "12 points whose state is invalid, 3 images ignored".
std::string losses_text(const io::Losses& losses);

}  // namespace lucarne::viewer
