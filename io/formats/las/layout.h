#pragma once

#include <span>

#include "io/formats/las/header.h"

// How a LAS record becomes a record of ours and back. The bit fields at the front of a LAS record are
// unpacked to one byte each; everything behind them (time, colour, near infrared, extra bytes) stands in the
// same order in both and is copied as it is: the *tail*.
namespace lucarne::io::las {

/// The schema of a point format with its extra bytes. `descriptors` is the data of the extra bytes record
/// (LASF_Spec 4), 192 bytes each, the first kMostEntries; bytes that none of them describes become
/// `extra_bytes` u8 xN. How extras are called: las_extras.h.
Schema make_schema(const Header& header);

/// An entry of the extra bytes record.
inline constexpr size_t kDescriptorBytes = 192;
struct ExtraType {
    ScalarType type = ScalarType::u8;
    uint32_t components = 1;
};
/// The whole entries of such a record, and no more than these: three times what an ordinary record can hold.
inline constexpr size_t kMostEntries = 1000;
std::span<const std::byte> entries_of(std::span<const std::byte> record);
/// Empty where the type is not in the specification.
std::optional<ExtraType> extra_type(std::span<const std::byte> descriptor);
std::string extra_name(std::span<const std::byte> descriptor);

/// The largest value that the bits of a field take (LAS 1.4 R15, tables 7 and 16); UINT32_MAX where it has
/// whole bytes.
uint32_t largest_value(bool extended, std::string_view name);

/// Unpacks `count` records of `header`'s format into records of make_schema(header).
void decode(const Header& header, const std::byte* in, size_t count, std::byte* out, size_t out_stride);
/// The inverse. False where a value does not fit its bit field (what is written then is of no use).
bool encode(const Header& header, const std::byte* in, size_t in_stride, size_t count, std::byte* out);

}  // namespace lucarne::io::las
