#include "io/formats/merged_info.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/formats/common/value_range.h"
#include "io/formats/las/crs.h"
#include "io/formats/las/extras.h"

namespace lucarne::io {
namespace {

/// Returns whether the scan counts for the common coordinate system. Files without points do not; nor do
/// files that only state a unit.
bool says_system(const ScanInfo& scan) {
    const bool named = !scan.coordinate_system.empty() && scan.coordinate_system != las::kLocalSystem;
    return scan.declared_points > 0 && (scan.epsg != 0 || named);
}
/// Compares codes where both scans have one, because every program writes the names differently.
bool same_system(const ScanInfo& a, const ScanInfo& b) {
    if (a.epsg && b.epsg) return a.epsg == b.epsg;
    return a.coordinate_system == b.coordinate_system;
}

/// The extra bytes of all LAS files, and the line for different_extras.
struct Extras {
    las::Vlr record{std::string(las::kSpecUser), las::kExtraBytesRecord, "", false, {}};
    std::string differ;
};
Extras merged_extras(std::span<const ScanInfo> scans) {
    Extras extras;
    for (const ScanInfo& scan : scans) {
        const auto record = scan.declared_points > 0 ? las::extras_record(scan.notes) : std::nullopt;
        if (!record) continue;
        const auto names = las::add_entries(extras.record, *record);
        if (!names.empty() && extras.differ.empty())
            extras.differ = fmt::format(
                "{}: '{}' has another scale, offset or type here than in an earlier file; the "
                "unscaled numbers are merged unchanged",
                scan.path, names.front());
    }
    return extras;
}

void merge_extras(std::span<const ScanInfo> scans, FormatNotes& notes) {
    Extras extras = merged_extras(scans);
    if (!extras.record.data.empty()) notes.extras = {std::move(extras.record)};
    if (!extras.differ.empty()) notes.extras_note = extras.differ;
}

/// Sets in `info` the coordinate system for all scans. On entry its notes are those of the first scan, or
/// empty.
void merge_systems(std::span<const ScanInfo> scans, ScanInfo& info) {
    FormatNotes& notes = info.notes;
    const auto giver = std::find_if(scans.begin(), scans.end(), says_system);
    if (giver == scans.end()) return;
    if (const std::string differ = different_systems(scans); !differ.empty()) {
        notes.projection.emplace();
        notes.system_note = differ + "; the written file has none";
        info.coordinate_system.clear();
        info.epsg = 0;
        return;
    }
    if (giver != scans.begin() || !notes.las) notes.projection = las::projection_records(giver->notes);
    info.coordinate_system = giver->coordinate_system;
    info.epsg = giver->epsg;
    const auto silent = std::find_if(scans.begin(), scans.end(), [](const ScanInfo& scan) {
        return scan.declared_points > 0 && !says_system(scan);
    });
    if (silent != scans.end())
        notes.system_note = fmt::format("{} has no coordinate system and is assumed to be in that of {}",
                                        silent->path, giver->path);
}

}  // namespace

bool same_unit(double metres, double others) {
    return std::abs(metres / others - 1) < kSameUnit;
}

std::string system_text(const ScanInfo& scan) {
    if (!scan.epsg) return scan.coordinate_system;
    const std::string code = fmt::format("EPSG:{}", scan.epsg);
    return scan.coordinate_system.empty() ? code : fmt::format("{} ({})", code, scan.coordinate_system);
}

std::string different_systems(std::span<const ScanInfo> scans) {
    const ScanInfo* first = nullptr;
    for (const ScanInfo& scan : scans) {
        if (!says_system(scan)) continue;
        if (!first) first = &scan;
        if (!same_system(*first, scan))
            return fmt::format("coordinate systems differ: {} is in {}, {} in {}", first->path,
                               system_text(*first), scan.path, system_text(scan));
    }
    return {};
}

std::string different_extras(std::span<const ScanInfo> scans) {
    return merged_extras(scans).differ;
}

ScanInfo merged_info(std::span<const ScanInfo> scans) {
    if (scans.empty()) return {};
    ScanInfo info = scans[0];
    if (scans.size() == 1) return info;
    bool all_las = info.notes.las.has_value(), same = true;
    std::optional<Range> limits = stated_range(info.notes);  // of all scans; empty if one states none
    for (const ScanInfo& scan : scans.subspan(1)) {
        all_las = all_las && scan.notes.las;
        same = same && scan.format == info.format;
        const auto range = stated_range(scan.notes);
        limits =
            limits && range
                ? std::optional(Range{std::min(limits->low, range->low), std::max(limits->high, range->high)})
                : std::nullopt;
    }
    if (!all_las && !same) info.notes = {};
    info.notes.intensity_limits.reset();
    if (limits) info.notes.intensity_limits = {limits->low, limits->high};
    merge_systems(scans, info);
    merge_extras(scans, info.notes);
    info.stations.clear();
    for (const auto& scan : scans)
        info.stations.insert(info.stations.end(), scan.stations.begin(), scan.stations.end());
    return info;
}

}  // namespace lucarne::io
