#include "octree/convert/build_inputs.h"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/far_apart.h"
#include "io/formats/merged_info.h"
#include "io/formats/scan.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"

namespace lucarne::octree {
namespace {

/// Whether a scan states its unit. Files without points do not count: some programs write them with a default
/// header.
bool in_stated_unit(const io::ScanInfo& scan) {
    return scan.declared_points > 0 && scan.unit_stated;
}

}  // namespace

Result<std::optional<bool>> wanted_normals(NormalsMode mode, const Unifier& inputs, bool complete) {
    size_t without = inputs.inputs();
    for (size_t i = inputs.inputs(); i-- > 0;)
        if (!inputs.has_normals(i)) without = i;
    const bool all = without == inputs.inputs();
    switch (mode) {
        case NormalsMode::none:
            return std::optional<bool>();
        case NormalsMode::automatic:
            return std::optional(!all || !complete);
        case NormalsMode::estimate:
            return std::optional(true);
        case NormalsMode::keep:
            break;
    }
    if (!all)
        return bad_arguments(inputs.source(without).info().path, "has no normals to keep",
                             "use --normals estimate");
    return std::optional(false);
}

double common_unit(const Unifier& inputs) {
    std::vector<double> stated;
    for (size_t i = 0; i < inputs.inputs(); ++i)
        if (const auto& scan = inputs.source(i).info(); in_stated_unit(scan))
            stated.push_back(scan.metres_per_unit);
    std::map<double, size_t> counts;
    // Programs write a foot with different numbers of digits.
    const auto count = [&](double unit) -> size_t& {
        const auto near = counts.lower_bound(unit * (1 - io::kSameUnit));
        return near != counts.end() && io::same_unit(near->first, unit) ? near->second : counts[unit];
    };
    for (const double unit : stated) ++count(unit);
    // The first of the most frequent ones.
    const auto most = std::ranges::max_element(stated, {}, count);
    return most == stated.end() ? 1.0 : *most;
}

Result<void> check_units(const Unifier& inputs) {
    const double common = common_unit(inputs);
    for (size_t i = 0; i < inputs.inputs(); ++i)
        LUCARNE_TRY(check_unit(inputs.source(i).info(), common, "the other inputs have"));
    return {};
}

Result<void> check_unit(const io::ScanInfo& scan, double metres_per_unit, std::string_view who) {
    if (!in_stated_unit(scan) || io::same_unit(scan.metres_per_unit, metres_per_unit)) return {};
    return rejected(
        scan.path,
        fmt::format("has a unit of {} m, {} one of {} m", scan.metres_per_unit, who, metres_per_unit),
        "convert it on its own, or set the unit of all with --unit if a file is wrong");
}

void warn_of_assumed_unit(const io::ScanInfo& scan, double metres_per_unit) {
    if (metres_per_unit != 1.0 && scan.declared_points > 0 && !scan.unit_stated)
        log::warn("{}: does not say its unit; that of the others is assumed, {} m (--unit overrides it)",
                  scan.path, metres_per_unit);
}

void warn_of_differences(const Unifier& inputs) {
    std::vector<io::ScanInfo> scans;
    for (size_t i = 0; i < inputs.inputs(); ++i) scans.push_back(inputs.source(i).info());
    warn_of_differences(scans);
}

void warn_of_differences(std::span<const io::ScanInfo> scans) {
    for (const std::string& differ :
         {io::different_systems(scans), io::different_extras(scans), io::far_apart(scans)})
        if (!differ.empty()) log::warn("{}", differ);
}

void widen_colour(io::ScanInfo& scan, const io::Schema& own, const io::Schema& schema) {
    const io::Attribute *from = own.find(io::names::color), *to = schema.find(io::names::color);
    if (from && to && from->type == io::ScalarType::u8 && to->type == io::ScalarType::u16)
        scan.color_bits = 16;
}

void adjust_colour(io::ScanInfo& scan, const io::Schema& own, const io::Schema& schema,
                   const io::Contents& contents) {
    widen_colour(scan, own, schema);
    const io::Attribute* color = own.find(io::names::color);
    if (!color || color->type == io::ScalarType::u8 || contents.color_bits <= scan.color_bits) return;
    log::warn("{}: has colours over {}, although those of the sample were not; its white is taken as {}",
              scan.path, io::color_white(scan.color_bits), io::color_white(contents.color_bits));
    scan.color_bits = contents.color_bits;
    scan.notes.color_bits = contents.color_bits;
}

Result<void> check_descriptions(const Unifier& inputs) {
    const size_t bytes = metadata_text(header_of(inputs, {}, inputs.schema())).size();
    if (bytes <= format::kMaxMetadata) return {};
    return bad_arguments("inputs",
                         fmt::format("the headers of {} files need {} bytes, and a cache can hold {}",
                                     inputs.inputs(), bytes, format::kMaxMetadata),
                         "convert them to several caches");
}

SourceHeader header_of(const Unifier& inputs, const ScanFacts& facts, const io::Schema& schema) {
    SourceHeader header{
        .schema = schema, .root = facts.root, .min = facts.min, .max = facts.max, .points = facts.points};
    header.metres_per_unit = common_unit(inputs);
    for (size_t i = 0; i < inputs.inputs(); ++i) {
        header.scans.push_back(inputs.source(i).info());
        if (!header.scans.back().unit_stated) header.scans.back().metres_per_unit = header.metres_per_unit;
        const auto contents = i < facts.inputs.size() ? facts.inputs[i] : io::Contents{};
        adjust_colour(header.scans.back(), inputs.source(i).schema(), schema, contents);
        if (i < facts.inputs.size()) header.scans.back().losses = contents.losses;
    }
    header.estimated_stations = facts.stations;
    return header;
}

}  // namespace lucarne::octree
