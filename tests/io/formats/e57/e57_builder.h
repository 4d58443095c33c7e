#pragma once

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/formats/e57/crc32c.h"
#include "io/formats/e57/pages.h"

// Builds E57 files by hand, so that every bit of them can be made wrong.
namespace lucarne::io::testing {

/// Cuts logical bytes into pages and appends their checksums. The last page is filled up with zeros.
inline std::string with_checksums(std::string_view logical) {
    std::string file;
    for (size_t at = 0; at < logical.size(); at += e57::kPageContent) {
        std::string page(logical.substr(at, e57::kPageContent));
        page.resize(e57::kPageContent);
        const uint32_t crc = e57::crc32c(std::as_bytes(std::span(page)));
        for (const int shift : {24, 16, 8, 0}) page += static_cast<char>(crc >> shift);
        file += page;
    }
    return file;
}

inline uint64_t physical(uint64_t logical) {
    return logical / e57::kPageContent * e57::kPageBytes + logical % e57::kPageContent;
}

template <class T>
void put(std::string& text, T value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The values of one field, bit after bit, lowest bit first.
struct BitStream {
    unsigned bits = 64;
    std::string bytes = {};
    size_t used = 0;  ///< number of bits used
    void add(uint64_t value) {
        for (unsigned bit = 0; bit < bits; ++bit, ++used) {
            if (used % 8 == 0) bytes += '\0';
            if (value >> bit & 1) bytes.back() = static_cast<char>(bytes.back() | 1 << used % 8);
        }
    }
    void add(double value) {
        uint64_t raw = 0;
        std::memcpy(&raw, &value, sizeof raw);
        add(raw);
    }
    void add(float value) {
        uint32_t raw = 0;
        std::memcpy(&raw, &value, sizeof raw);
        add(uint64_t{raw});
    }
};

/// Returns a data packet, padded to four bytes.
inline std::string data_packet(const std::vector<std::string>& streams) {
    std::string packet("\1\0\0\0", 4);
    put(packet, static_cast<uint16_t>(streams.size()));
    for (const auto& s : streams) put(packet, static_cast<uint16_t>(s.size()));
    for (const auto& s : streams) packet += s;
    packet.resize((packet.size() + 3) / 4 * 4);
    const auto less_one = static_cast<uint16_t>(packet.size() - 1);
    std::memcpy(&packet[2], &less_one, 2);
    return packet;
}

/// Returns a packet of `type` without points.
inline std::string other_packet(char type, size_t bytes) {
    std::string packet(bytes, '\x5a');
    packet[0] = type;
    const auto less_one = static_cast<uint16_t>(bytes - 1);
    std::memcpy(&packet[2], &less_one, 2);
    return packet;
}

struct BuiltScan {
    std::string prototype;  ///< XML of the fields
    uint64_t records = 0;
    std::string packets;
    std::string more = {};  ///< further XML: pose, limits
    // False values:
    std::string record_count = {}, file_offset = {};  ///< as text
    std::function<void(std::string&)> spoil = {};     ///< changes the section with its header (32 bytes)
};

struct BuiltFile {
    std::vector<BuiltScan> scans;
    std::string images = {};
    std::string header_xml = {};  ///< before the root element
    std::string xml = {};         ///< replaces all XML

    /// Returns the bytes without checksums.
    std::string logical() const {
        std::string file(e57::kHeaderBytes, '\0'), data3d;
        for (const BuiltScan& scan : scans) {
            const uint64_t offset = physical(file.size());
            std::string section("\1\0\0\0\0\0\0\0", 8);
            put(section, uint64_t{32 + scan.packets.size()});
            put(section, physical(file.size() + 32));
            put(section, uint64_t{0});
            section += scan.packets;
            if (scan.spoil) scan.spoil(section);
            file += section;
            data3d += fmt::format(
                "<vectorChild type=\"Structure\"><name type=\"String\"><![CDATA[a <scan>]]></name>{}"
                "<points type=\"CompressedVector\" fileOffset=\"{}\" recordCount=\"{}\"><prototype "
                "type=\"Structure\">{}</prototype><codecs type=\"Vector\"/></points></vectorChild>",
                scan.more, scan.file_offset.empty() ? std::to_string(offset) : scan.file_offset,
                scan.record_count.empty() ? std::to_string(scan.records) : scan.record_count, scan.prototype);
        }
        const std::string document =
            !xml.empty() ? xml
                         : "<?xml version=\"1.0\" encoding=\"UTF-8\"?>" + header_xml +
                               "<e57Root type=\"Structure\"><data3D type=\"Vector\">" + data3d +
                               "</data3D><images2D type=\"Vector\">" + images + "</images2D></e57Root>";
        const uint64_t xml_offset = physical(file.size());
        file += document;
        std::string header("ASTM-E57");
        put(header, 1u);
        put(header, 0u);
        put(header, (file.size() + e57::kPageContent - 1) / e57::kPageContent * e57::kPageBytes);
        put(header, xml_offset);
        put(header, uint64_t{document.size()});
        put(header, e57::kPageBytes);
        return file.replace(0, header.size(), header);
    }
    std::string bytes() const { return with_checksums(logical()); }
};

inline std::string float_field(const std::string& name, const std::string& precision = "double") {
    return fmt::format("<{} type=\"Float\" precision=\"{}\"/>", name, precision);
}
inline std::string integer_field(const std::string& name, int64_t minimum, int64_t maximum) {
    return fmt::format("<{} type=\"Integer\" minimum=\"{}\" maximum=\"{}\"/>", name, minimum, maximum);
}
inline std::string scaled_field(const std::string& name, int64_t minimum, int64_t maximum,
                                const std::string& scale, const std::string& offset = "0") {
    return fmt::format(
        "<{} type=\"ScaledInteger\" minimum=\"{}\" maximum=\"{}\" scale=\"{}\" offset=\"{}\"/>", name,
        minimum, maximum, scale, offset);
}

/// Returns three double coordinates and `more` streams in one packet.
inline std::string xyz_packet(const std::vector<std::array<double, 3>>& points,
                              const std::vector<std::string>& more = {}) {
    std::vector<std::string> streams;
    for (size_t axis = 0; axis < 3; ++axis) {
        BitStream stream;
        for (const auto& p : points) stream.add(p[axis]);
        streams.push_back(stream.bytes);
    }
    streams.insert(streams.end(), more.begin(), more.end());
    return data_packet(streams);
}
inline const std::string kXyzFields =
    float_field("cartesianX") + float_field("cartesianY") + float_field("cartesianZ");

}  // namespace lucarne::io::testing
