#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/formats/las/layout.h"

// Extra bytes hold attributes for which a point format has no field, or none of the right type; this file
// also handles their names. If a field cannot hold an attribute exactly (such as an intensity of floats), the
// extra bytes hold the exact value and the field holds an approximation. Other tools cannot tell two
// dimensions with one name apart, so the exact one is called original_NAME in the file. In a schema here it
// is NAME, and the field is las_NAME.
namespace lucarne::io::las {

inline constexpr std::string_view kNearPrefix = "las_";

/// Returns the name of an extra in make_schema: NAME for Lucarne's own original_NAME, otherwise the entry's
/// name. `fields` is the schema of the point format.
struct ExtraName {
    std::string name;
    bool original = false;
};
ExtraName name_of_extra(const Schema& fields, std::span<const std::byte> descriptor);

/// Returns whether the first three entries are the components of a normal, as CloudCompare and PDAL write
/// them: NormalX, NormalY and NormalZ (or nx, ny, nz) of one real type, without scale and offset. They become
/// one attribute, `normal`.
bool is_normal(std::span<const std::byte> entries);

/// Returns the attributes of the point format, with which a record of make_schema(header) begins. They have
/// their usual names, whatever extra bytes are called.
Schema fields_of(const Header& header);

/// Returns the attributes of `schema` that become extra bytes, in record order. Undescribed bytes come last.
std::vector<Attribute> extra_attributes(const Header& header, const Schema& schema);

/// Returns the extra bytes record in the notes of a scan: a LAS file's own, or that of merged_info.
std::optional<Vlr> extras_record(const FormatNotes& notes);

/// Adds to `record` the entries of another file's record, except those that it has already. Where an entry of
/// both differs in scale, offset or type, the entry loses its scale and offset. Returns the names of these
/// entries.
std::vector<std::string> add_entries(Vlr& record, const Vlr& more);

/// Returns what the attributes of `schema` mean whose whole numbers LAS files scale: "'Amplitude' * 0.01 +
/// 0". Empty if there are none.
std::string scaled_extras(const ScanInfo& info, const Schema& schema);

/// Sets the header's record length and its extra bytes record. Errors: more than LAS can hold.
Result<void> describe_extras(const std::string& path, Header& header, const std::vector<Attribute>& extra);

}  // namespace lucarne::io::las
