#pragma once

#include <span>

#include "io/formats/las/header.h"

// Converts a LAS record to a record of the schema and back. The bit fields at the front of a LAS record are
// unpacked to one byte each. Everything after them (time, colour, near infrared, extra bytes) has the same
// order in both and is copied unchanged; it is called the *tail*.
namespace lucarne::io::las {

/// Returns the schema of a point format with its extra bytes. The extra bytes record (LASF_Spec 4) describes
/// these in entries of 192 bytes, of which the first kMostEntries count. Bytes without an entry become
/// `extra_bytes` u8 xN. For the names of extras see extras.h.
Schema make_schema(const Header& header);

/// Size of an entry of the extra bytes record.
inline constexpr size_t kDescriptorBytes = 192;
struct ExtraType {
    ScalarType type = ScalarType::u8;
    uint32_t components = 1;
};
/// Returns the complete entries of such a record, but at most kMostEntries: three times as many as an
/// ordinary record can hold.
inline constexpr size_t kMostEntries = 1000;
std::span<const std::byte> entries_of(std::span<const std::byte> record);
/// Returns the type of an entry; empty if the specification has no such type.
std::optional<ExtraType> extra_type(std::span<const std::byte> descriptor);
std::string extra_name(std::span<const std::byte> descriptor);

/// Returns the largest value that fits the bits of a field (LAS 1.4 R15, tables 7 and 16); UINT32_MAX if the
/// field has whole bytes.
uint32_t largest_value(bool extended, std::string_view name);

/// Unpacks `count` records of `header`'s format into records of make_schema(header).
void decode(const Header& header, const std::byte* in, size_t count, std::byte* out, size_t out_stride);
/// The inverse. Returns false if a value does not fit its bit field; the output is then invalid.
bool encode(const Header& header, const std::byte* in, size_t in_stride, size_t count, std::byte* out);

}  // namespace lucarne::io::las
