#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/formats/las/layout.h"

// What a point format has no field for, or none of its type: the extra bytes of a record, and what they are
// called. An attribute whose field cannot hold it (an intensity of floats) stands there whole, while the
// field has what comes near. Other tools cannot tell two dimensions of one name apart, so the whole one is
// called original_NAME in the file; our schema calls it NAME and the field las_NAME.
namespace lucarne::io::las {

inline constexpr std::string_view kNearPrefix = "las_";

/// What make_schema calls an extra: NAME of an original_NAME of ours, else the entry's own name. `fields` are
/// those of the point format.
struct ExtraName {
    std::string name;
    bool original = false;
};
ExtraName name_of_extra(const Schema& fields, std::span<const std::byte> descriptor);

/// What a record of make_schema(header) begins with, whatever stands in extra bytes and is called by the
/// names of fields.
Schema fields_of(const Header& header);

/// The attributes of `schema` that go to extra bytes, in record order; bytes that nobody described come last.
std::vector<Attribute> extra_attributes(const Header& header, const Schema& schema);

/// The record of extra bytes in the notes of a scan: a LAS file's own, or that of merged_info.
std::optional<Vlr> extras_record(const FormatNotes& notes);

/// Adds what another file's record describes to `record`, unless that does already. Gives the names of those
/// whose numbers mean another thing there (by scale or offset): they have neither then.
std::vector<std::string> add_entries(Vlr& record, const Vlr& more);

/// What the attributes of `schema` stand for whose whole numbers LAS files scale: "'Amplitude' * 0.01 + 0".
/// Empty where there are none.
std::string scaled_extras(const ScanInfo& info, const Schema& schema);

/// Sets the header's record length and its record of extra bytes. Errors: more than LAS can hold.
Result<void> describe_extras(const std::string& path, Header& header, const std::vector<Attribute>& extra);

}  // namespace lucarne::io::las
