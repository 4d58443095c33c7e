#pragma once

#include <optional>
#include <span>
#include <string>

#include "io/points.h"

// What a file that holds the points of several scans can say of them all.
namespace lucarne::io {

/// Whether two units of length are one: some programs write fewer digits of a US survey foot than others.
/// (The two feet are 2e-6 apart.)
inline constexpr double kSameUnit = 1e-9;
bool same_unit(double metres, double others);

/// "EPSG:2903, NAD83 / ..." as far as the scan says it; empty where it says nothing.
std::string system_text(const ScanInfo& scan);

/// One line that names the first two scans whose coordinate systems differ; empty where none do. A scan that
/// says nothing differs from none.
std::string different_systems(std::span<const ScanInfo> scans);

/// One line that names an attribute in the extra bytes of LAS files whose scale or offset is not that of the
/// file before; empty where there is none.
std::string different_extras(std::span<const ScanInfo> scans);

/// The stations of all scans; the first's notes (header, types) where all are of one format, LAS and LAZ
/// being one; all descriptions of extra bytes; their coordinate system where they agree. Scans that differ in
/// it leave none, those that say nothing are taken to be in that of the others; a note tells so.
ScanInfo merged_info(std::span<const ScanInfo> scans);

}  // namespace lucarne::io
