#pragma once

#include <optional>
#include <span>
#include <string>

#include "io/points.h"

// What can be said about all scans together when one file holds the points of several scans.
namespace lucarne::io {

/// Returns whether two units of length are the same. Some programs write a US survey foot with fewer digits
/// than others. (The US survey foot and the international foot differ by 2e-6.)
inline constexpr double kSameUnit = 1e-9;
bool same_unit(double metres, double others);

/// Returns "EPSG:2903, NAD83 / ...", as far as the scan states it; empty if it states nothing.
std::string system_text(const ScanInfo& scan);

/// Returns one line that names the first two scans whose coordinate systems differ; empty if none differ. A
/// scan without a coordinate system differs from no other.
std::string different_systems(std::span<const ScanInfo> scans);

/// Returns one line that names an attribute in the extra bytes of LAS files whose scale, offset or type
/// differs from an earlier file's; empty if there is none.
std::string different_extras(std::span<const ScanInfo> scans);

/// Merges the information on several scans:
///  - the stations of all scans;
///  - the first scan's notes (header, types), if all scans have the same format (LAS and LAZ count as one);
///  - the descriptions of all extra bytes;
///  - the coordinate system, if the scans agree on it.
/// Scans with different coordinate systems leave none. Scans without a coordinate system are taken to be in
/// that of the others. A note says so in both cases.
ScanInfo merged_info(std::span<const ScanInfo> scans);

}  // namespace lucarne::io
