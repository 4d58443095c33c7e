#include "io/formats/las/extras.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>

#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::las {
namespace {

constexpr std::string_view kOriginalPrefix = "original_", kOriginalDescription = "lucarne: of its own type";
constexpr size_t kTypeAt = 2, kOptionsAt = 3, kNameAt = 4, kNameBytes = 32, kScaleAt = 112, kOffsetAt = 136,
                 kDescriptionAt = 160;
constexpr uint8_t kRangeBits = 6, kScaleBit = 8, kOffsetBit = 16;  ///< option bits: which entries are valid

bool is_float(ScalarType t) {
    return t == ScalarType::f32 || t == ScalarType::f64;
}
bool is_signed(ScalarType t) {
    return t == ScalarType::i8 || t == ScalarType::i16 || t == ScalarType::i32 || t == ScalarType::i64;
}
/// Returns whether `wide` can hold every value of `narrow`.
bool holds(ScalarType wide, ScalarType narrow) {
    if (wide == narrow) return true;
    const size_t w = scalar_bytes(wide), n = scalar_bytes(narrow);
    if (is_float(wide))
        return w > n;  // f64 holds f32 and integers up to 32 bits; f32 holds integers up to
                       // 16 bits
    if (is_float(narrow)) return false;
    return w > n && (is_signed(wide) || !is_signed(narrow));
}

/// Returns whether a field of the point format can hold the attribute exactly.
bool has_field(const Schema& fields, const Attribute& attribute) {
    const Attribute* field = fields.find(attribute.name);
    return field && field->components == attribute.components && holds(field->type, attribute.type);
}

/// Returns whether a name is used for a field of the record, by LAS readers (in any case) or by Lucarne.
/// Other readers have three fields for colour, Lucarne has one.
bool is_reserved(const Schema& fields, std::string_view name) {
    constexpr std::array<std::string_view, 24> kDimensions = {"x",
                                                              "y",
                                                              "z",
                                                              "intensity",
                                                              "bit_fields",
                                                              "raw_classification",
                                                              "classification_flags",
                                                              "return_number",
                                                              "number_of_returns",
                                                              "synthetic",
                                                              "key_point",
                                                              "withheld",
                                                              "overlap",
                                                              "scanner_channel",
                                                              "scan_direction_flag",
                                                              "edge_of_flight_line",
                                                              "classification",
                                                              "user_data",
                                                              "scan_angle",
                                                              "point_source_id",
                                                              "gps_time",
                                                              "red",
                                                              "green",
                                                              "blue"};
    std::string lower(name);
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return lower == names::nir ||
           std::find(kDimensions.begin(), kDimensions.end(), lower) != kDimensions.end() ||
           (name != names::color && fields.find(name));
}

/// Returns where the `nth` entry with that name begins in a record's data.
std::optional<size_t> find_entry(const Vlr& record, std::string_view name, size_t nth) {
    const auto entries = entries_of(record.data);
    for (size_t at = 0; at < entries.size(); at += kDescriptorBytes)
        if (printable(extra_name(entries.subspan(at, kDescriptorBytes))) == name && --nth == 0) return at;
    return std::nullopt;
}

/// Returns the source's own entry for the `nth` attribute of this name; empty if it had none.
std::span<const std::byte> kept_entry(const Vlr* kept, const Attribute& attribute, std::string_view name,
                                      size_t nth = 1) {
    const auto at = kept ? find_entry(*kept, name, nth) : std::nullopt;
    if (!at) return {};
    const auto entry = std::span(kept->data).subspan(*at, kDescriptorBytes);
    const auto type = extra_type(entry);
    const bool same = type && type->type == attribute.type && type->components == attribute.components;
    return same ? entry : std::span<const std::byte>();
}

/// Returns the scales and offsets of an entry's components; undocumented bytes have none.
constexpr std::array<double, 6> kPlain = {1, 1, 1, 0, 0, 0};
std::array<double, 6> scaling(std::span<const std::byte> entry) {
    auto all = kPlain;
    const auto type = extra_type(entry);
    if (!type || entry[kTypeAt] == std::byte{0}) return all;
    const auto options = load<uint8_t>(&entry[kOptionsAt]);
    for (size_t c = 0; c < type->components; ++c) {
        if (options & kScaleBit) all[c] = load<double>(&entry[kScaleAt + 8 * c]);
        if (options & kOffsetBit) all[3 + c] = load<double>(&entry[kOffsetAt + 8 * c]);
    }
    return all;
}

/// Returns whether equal numbers mean equal values in both entries, so that one entry can stand for both.
bool alike(std::span<const std::byte> a, std::span<const std::byte> b) {
    const auto values = scaling(a);
    return values == scaling(b) && (a[kTypeAt] == b[kTypeAt] || values == kPlain);
}

void clear_options(Vlr& record, size_t entry, uint8_t bits) {
    std::byte& options = record.data[entry + kOptionsAt];
    if (record.data[entry + kTypeAt] != std::byte{0})
        options &= static_cast<std::byte>(~bits);  // otherwise they are a size
}

/// Returns the entry of an attribute whose name got a number when it was read, because another attribute or a
/// field already had the name: see unique_name.
std::span<const std::byte> numbered_entry(const Vlr* kept, const Attribute& attribute, const Schema& fields) {
    const size_t bar = attribute.name.rfind('_');
    if (bar == std::string::npos) return {};
    const auto name = std::string_view(attribute.name).substr(0, bar);
    const auto number = parse_number<size_t>(std::string_view(attribute.name).substr(bar + 1));
    if (!number || *number < 2) return {};
    return kept_entry(kept, attribute, name, fields.find(name) ? *number - 1 : *number);
}

/// Returns at most `most` bytes of `name`, without a partial character at the end.
std::string cut_to(const std::string& name, size_t most) {
    size_t end = std::min(name.size(), most);
    while (end < name.size() && end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    return name.substr(0, end);
}

/// Returns as much of `name` as an entry holds, with a number if another entry has the same. laspy opens no
/// file in which two names are equal or end in a partial character.
std::string entry_name(const std::string& name, std::set<std::string>& taken) {
    std::string own = cut_to(name, kNameBytes);
    for (size_t number = 2; !taken.insert(own).second; ++number) {
        const std::string suffix = fmt::format("_{}", number);
        own = cut_to(name, kNameBytes - suffix.size()) + suffix;
    }
    return own;
}

/// Returns the entry of the extra bytes record for an attribute: the source's own entry if it had one.
Result<std::vector<std::byte>> descriptor_of(const std::string& path, const Attribute& attribute,
                                             const Schema& fields, const Vlr* kept,
                                             std::set<std::string>& taken) {
    auto own = kept_entry(kept, attribute, attribute.name);
    if (own.empty()) own = numbered_entry(kept, attribute, fields);
    const bool original = is_reserved(fields, attribute.name) && (own.empty() || fields.find(attribute.name));
    const std::string name = original ? std::string(kOriginalPrefix) + attribute.name : attribute.name;
    if (original) own = kept_entry(kept, attribute, name);
    std::vector<std::byte> entry(own.begin(), own.end());
    entry.resize(kDescriptorBytes);
    const std::string written = entry_name(name, taken);
    std::fill_n(entry.begin() + kNameAt, kNameBytes, std::byte{0});
    std::memcpy(&entry[kNameAt], written.data(), written.size());
    if (!own.empty()) return entry;
    const size_t bytes = attribute.bytes();
    if (attribute.components <= 3) {
        store(&entry[kTypeAt],
              static_cast<uint8_t>(static_cast<unsigned>(attribute.type) + 10 * (attribute.components - 1)));
    } else if (bytes <= 255) {
        store(&entry[kOptionsAt], static_cast<uint8_t>(bytes));  // undocumented: size in place of type
    } else {
        return failed(path,
                      fmt::format("LAS cannot hold the attribute {} of {} bytes", attribute.name, bytes),
                      "choose PLY");
    }
    if (original)
        std::memcpy(&entry[kDescriptionAt], kOriginalDescription.data(), kOriginalDescription.size());
    return entry;
}

/// Returns the entries of a normal: three, which other programs know, unless the source had one.
Result<std::vector<std::byte>> descriptors_of_normal(const std::string& path, const Attribute& normal,
                                                     const Schema& fields, const Vlr* kept,
                                                     std::set<std::string>& taken) {
    const bool parts = normal.components == 3 && is_float(normal.type);
    if (!parts || !kept_entry(kept, normal, normal.name).empty())
        return descriptor_of(path, normal, fields, kept, taken);
    std::array<std::string, 3> theirs = {"NormalX", "NormalY", "NormalZ"};
    const auto entries = kept ? entries_of(kept->data) : std::span<const std::byte>();
    for (size_t at = 0; at < entries.size(); at += kDescriptorBytes)
        if (is_normal(entries.subspan(at))) {
            for (size_t k = 0; k < 3; ++k)
                theirs[k] = printable(extra_name(entries.subspan(at + k * kDescriptorBytes)));
            break;
        }
    std::vector<std::byte> described;
    for (const std::string& name : theirs) {
        const Attribute part{name, normal.type, 1, 0};
        LUCARNE_ASSIGN(const auto entry, descriptor_of(path, part, fields, kept, taken));
        described.insert(described.end(), entry.begin(), entry.end());
    }
    return described;
}

/// Returns the record, and creates it if it is missing.
Vlr& extra_record(Header& header) {
    const auto found = std::find_if(header.vlrs.begin(), header.vlrs.end(),
                                    [](const Vlr& v) { return v.is(kSpecUser, kExtraBytesRecord); });
    if (found != header.vlrs.end()) return *found;
    header.vlrs.push_back({std::string(kSpecUser), kExtraBytesRecord, "", false, {}});
    return header.vlrs.back();
}

}  // namespace

bool is_normal(std::span<const std::byte> entries) {
    if (entries.size() < 3 * kDescriptorBytes) return false;
    const auto first = extra_type(entries);
    if (!first || !is_float(first->type)) return false;
    for (const std::string_view stem : {"normal", "n"}) {
        bool all = true;
        for (size_t k = 0; all && k < 3; ++k) {
            const auto entry = entries.subspan(k * kDescriptorBytes, kDescriptorBytes);
            const auto type = extra_type(entry);
            all = type && type->type == first->type && type->components == 1 && scaling(entry) == kPlain &&
                  same_letters(extra_name(entry), std::string(stem) + "xyz"[k]);
        }
        if (all) return true;
    }
    return false;
}

ExtraName name_of_extra(const Schema& fields, std::span<const std::byte> descriptor) {
    const std::string name = extra_name(descriptor);
    const std::string_view description(reinterpret_cast<const char*>(&descriptor[kDescriptionAt]),
                                       kOriginalDescription.size());
    if (!name.starts_with(kOriginalPrefix) || description != kOriginalDescription) return {name};
    std::string own = name.substr(kOriginalPrefix.size());
    return is_reserved(fields, own) ? ExtraName{std::move(own), true} : ExtraName{name};
}

Schema fields_of(const Header& header) {
    Header bare;
    bare.point_format = header.point_format;
    bare.record_length = record_bytes(header.point_format);
    return make_schema(bare);
}

std::vector<Attribute> extra_attributes(const Header& header, const Schema& schema) {
    const Schema fields = fields_of(header);
    std::vector<Attribute> extra;
    for (const Attribute& a : schema.attributes) {
        Attribute plain = a;
        if (a.name.starts_with(kNearPrefix)) {
            plain.name = a.name.substr(kNearPrefix.size());
            const Attribute* original = schema.find(plain.name);
            if (original && !has_field(fields, *original) && has_field(fields, plain)) continue;
        }
        if (!has_field(fields, a)) extra.push_back(a);
    }
    std::stable_partition(extra.begin(), extra.end(),
                          [](const Attribute& a) { return a.name != "extra_bytes"; });
    return extra;
}

std::optional<Vlr> extras_record(const FormatNotes& notes) {
    if (!notes.extras && !notes.las) return std::nullopt;
    const std::vector<Vlr>& records = notes.extras ? *notes.extras : notes.las->vlrs;
    const auto found = std::find_if(records.begin(), records.end(),
                                    [](const Vlr& v) { return v.is(kSpecUser, kExtraBytesRecord); });
    return found == records.end() ? std::nullopt : std::optional(*found);
}

std::vector<std::string> add_entries(Vlr& record, const Vlr& more) {
    std::vector<std::string> differing;
    std::map<std::string, size_t> times;  // either record may hold a name more than once
    const auto entries = entries_of(more.data);
    for (size_t at = 0; at < entries.size(); at += kDescriptorBytes) {
        const auto entry = entries.subspan(at, kDescriptorBytes);
        const std::string name = printable(extra_name(entry));
        if (const auto there = find_entry(record, name, ++times[name])) {
            const bool same = alike(std::span(record.data).subspan(*there, kDescriptorBytes), entry);
            if (!same) differing.push_back(name);
            clear_options(record, *there, same ? kRangeBits : kRangeBits | kScaleBit | kOffsetBit);
        } else if (record.data.size() < kMostEntries * kDescriptorBytes) {
            record.data.insert(record.data.end(), entry.begin(), entry.end());
        }
    }
    return differing;
}

std::string scaled_extras(const ScanInfo& info, const Schema& schema) {
    const auto record = extras_record(info.notes);
    if (!record) return {};
    Schema fields;
    if (info.notes.las && info.notes.las_damage.empty()) fields = fields_of(Header{*info.notes.las});
    std::string text;
    for (const Attribute& a : schema.attributes) {
        auto entry = kept_entry(&*record, a, a.name);
        if (entry.empty()) entry = numbered_entry(&*record, a, fields);
        const auto scales = entry.empty() ? kPlain : scaling(entry);
        if (scales != kPlain)
            text += fmt::format("{}'{}' * {} + {}", text.empty() ? "" : ", ", a.name, scales[0], scales[3]);
    }
    return text;
}

Result<void> describe_extras(const std::string& path, Header& header, const std::vector<Attribute>& extra) {
    const Schema fields = fields_of(header);
    const Vlr* kept = header.find(kSpecUser, kExtraBytesRecord);
    std::vector<std::byte> described;
    std::set<std::string> names;
    size_t bytes = record_bytes(header.point_format);
    for (const Attribute& a : extra) {
        bytes += a.bytes();
        if (a.name != "extra_bytes" || a.type != ScalarType::u8) {
            const auto describe = a.name == io::names::normal ? descriptors_of_normal : descriptor_of;
            LUCARNE_ASSIGN(const auto entry, describe(path, a, fields, kept, names));
            described.insert(described.end(), entry.begin(), entry.end());
        }
        if (bytes > 0xffff || described.size() > 0xffff)
            return failed(path, "has more attributes than a LAS record can hold", "choose PLY");
    }
    header.record_length = static_cast<uint16_t>(bytes);
    if (described.empty())
        std::erase_if(header.vlrs, [](const Vlr& v) { return v.is(kSpecUser, kExtraBytesRecord); });
    else
        extra_record(header).data = std::move(described);
    return {};
}

}  // namespace lucarne::io::las
