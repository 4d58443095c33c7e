#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

// Builds LAS files by hand from the specification, independent of Lucarne's writer: fields at their offsets.
namespace lucarne::io::testing {

template <class T>
void put(std::string& bytes, size_t at, T value) {
    if (bytes.size() < at + sizeof value) bytes.resize(at + sizeof value);
    std::memcpy(&bytes[at], &value, sizeof value);
}
template <class T>
void append(std::string& bytes, T value) {
    put(bytes, bytes.size(), value);
}
inline void append_text(std::string& bytes, std::string text, size_t width) {
    text.resize(width);
    bytes += text;
}

/// A LAS file in which every field can be made false.
struct LasFile {
    uint8_t major = 1, minor = 2, format = 0;
    uint16_t encoding = 0, record_length = 0;
    double scale[3] = {0.01, 0.01, 0.01}, offset[3] = {0, 0, 0};
    std::pair<double, double> box{0, 0};  ///< smallest and largest value of each axis
    std::vector<std::string> vlrs, evlrs, records;
    // Values that the header states instead of the true ones.
    int64_t said_points = -1, said_old_points = -1, said_vlrs = -1, said_points_offset = -1,
            said_header_size = -1, said_evlrs = -1, said_evlr_offset = -1;

    void add_vlr(const std::string& user, uint16_t id, const std::string& data, bool extended = false) {
        std::string v;
        append<uint16_t>(v, 0);
        append_text(v, user, 16);
        append(v, id);
        if (extended)
            append<uint64_t>(v, data.size());
        else
            append(v, static_cast<uint16_t>(data.size()));
        append_text(v, "made by hand", 32);
        (extended ? evlrs : vlrs).push_back(v + data);
    }

    std::string bytes() const {
        const size_t header_size = minor >= 4 ? 375 : minor == 3 ? 235 : 227;
        std::string b(header_size, '\0');
        std::memcpy(&b[0], "LASF", 4);
        put(b, 6, encoding);
        put(b, 24, major);
        put(b, 25, minor);
        std::memcpy(&b[26], "system", 6);
        std::memcpy(&b[58], "software", 8);
        put(b, 94,
            static_cast<uint16_t>(said_header_size < 0 ? static_cast<int64_t>(header_size)
                                                       : said_header_size));
        for (const auto& v : vlrs) b += v;
        const auto points_offset = static_cast<int64_t>(b.size());
        put(b, 96, static_cast<uint32_t>(said_points_offset < 0 ? points_offset : said_points_offset));
        put(b, 100, static_cast<uint32_t>(said_vlrs < 0 ? static_cast<int64_t>(vlrs.size()) : said_vlrs));
        put(b, 104, format);
        const size_t length = record_length ? record_length : records.empty() ? 20 : records[0].size();
        put(b, 105, static_cast<uint16_t>(length));
        const auto count = static_cast<int64_t>(records.size());
        const int64_t old_points = minor >= 4 && format >= 6 ? 0 : count;
        put(b, 107, static_cast<uint32_t>(said_old_points < 0 ? old_points : said_old_points));
        for (size_t axis = 0; axis < 3; ++axis) {
            put(b, 131 + 8 * axis, scale[axis]);
            put(b, 155 + 8 * axis, offset[axis]);
            put(b, 179 + 16 * axis, box.second);
            put(b, 187 + 16 * axis, box.first);
        }
        for (const auto& r : records) b += r;
        if (minor >= 4) {
            put(b, 235,
                static_cast<uint64_t>(said_evlr_offset < 0 ? static_cast<int64_t>(b.size())
                                                           : said_evlr_offset));
            put(b, 243,
                static_cast<uint32_t>(said_evlrs < 0 ? static_cast<int64_t>(evlrs.size()) : said_evlrs));
            put(b, 247, static_cast<uint64_t>(said_points < 0 ? count : said_points));
        }
        for (const auto& v : evlrs) b += v;
        return b;
    }
};

/// Returns a record of point format 0 (20 bytes) with the given two bytes of bit fields.
inline std::string record0(int32_t x, int32_t y, int32_t z, uint16_t intensity = 0, uint8_t flags = 0,
                           uint8_t classes = 0, int8_t angle = 0, uint8_t user = 0, uint16_t source = 0) {
    std::string r;
    append(r, x);
    append(r, y);
    append(r, z);
    append(r, intensity);
    append(r, flags);
    append(r, classes);
    append(r, angle);
    append(r, user);
    append(r, source);
    return r;
}

/// Returns a record of point format 6 (30 bytes).
inline std::string record6(int32_t x, int32_t y, int32_t z, uint16_t intensity, uint8_t returns,
                           uint8_t flags, uint8_t classes, uint8_t user, int16_t angle, uint16_t source,
                           double time) {
    std::string r;
    append(r, x);
    append(r, y);
    append(r, z);
    append(r, intensity);
    append(r, returns);
    append(r, flags);
    append(r, classes);
    append(r, user);
    append(r, angle);
    append(r, source);
    append(r, time);
    return r;
}

inline std::string rgb(uint16_t r, uint16_t g, uint16_t b) {
    std::string bytes;
    append(bytes, r);
    append(bytes, g);
    append(bytes, b);
    return bytes;
}

template <class T>
std::string raw(T value) {
    std::string bytes;
    append(bytes, value);
    return bytes;
}

/// Returns an entry of the extra bytes record.
inline std::string extra_descriptor(uint8_t type, const std::string& name, uint8_t options = 0) {
    std::string d(192, '\0');
    d[2] = static_cast<char>(type);
    d[3] = static_cast<char>(options);
    std::memcpy(&d[4], name.data(), std::min<size_t>(32, name.size()));
    return d;
}

}  // namespace lucarne::io::testing
