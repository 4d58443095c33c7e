// Makes PCD in its three encodings: floats with colour and normals, doubles, an organised cloud with holes.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {
namespace {

/// The same points for all encodings, as columns of fields.
struct Cloud {
    std::string header;  ///< up to WIDTH
    int width = 1, height = 1;
    std::vector<std::vector<std::string>> columns;  ///< bytes of each field of each point
    std::string text;
};

template <class T>
std::string raw(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

Cloud organised() {
    Cloud cloud{
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb normal_x normal_y "
        "normal_z _ label\nSIZE 4 4 4 4 4 4 4 1 2\nTYPE F F F U F F F U I\nCOUNT 1 1 1 1 1 1 1 3 1\n",
        3, 2, std::vector<std::vector<std::string>>(9), ""};
    for (int i = 0; i < 6; ++i) {
        const float x = i == 2 ? NAN : 0.5f * static_cast<float>(i);
        const std::array<std::string, 9> fields = {
            raw(x),   raw(-2.5f), raw(3.25f), raw(0x00102030 + i),          raw(0.f),
            raw(0.f), raw(1.f),   "abc",      raw(static_cast<int16_t>(-i))};
        for (size_t f = 0; f < fields.size(); ++f) cloud.columns[f].push_back(fields[f]);
        cloud.text += fmt::format("{} -2.5 3.25 {} 0 0 1 97 98 99 {}\n", x, 0x00102030 + i, -i);
    }
    return cloud;
}

Cloud doubles() {
    Cloud cloud{"VERSION .7\nFIELDS x y z intensity\nSIZE 8 8 8 4\nTYPE F F F F\nCOUNT 1 1 1 1\n", 4, 1,
                std::vector<std::vector<std::string>>(4), ""};
    for (int i = 0; i < 4; ++i) {
        const std::array<double, 3> p = {500000.125 + i, 4e6, 1e-3 * i};
        for (size_t axis = 0; axis < 3; ++axis) cloud.columns[axis].push_back(raw(p[axis]));
        cloud.columns[3].push_back(raw(0.25f));
        cloud.text += fmt::format("{} {} {} 0.25\n", p[0], p[1], p[2]);
    }
    return cloud;
}

/// Compresses with LZF: literal bytes, and after the first eight a copy of four bytes where it fits.
std::string compressed(const std::string& bytes) {
    std::string packed;
    for (size_t at = 0; at < bytes.size();) {
        if (at >= 8 && bytes.compare(at, 4, bytes, at - 4, 4) == 0 && at + 4 <= bytes.size()) {
            packed += "\x40\x03";  // 2 + 2 bytes from 4 back
            at += 4;
            continue;
        }
        const size_t count = std::min<size_t>(4, bytes.size() - at);
        packed += static_cast<char>(count - 1);
        packed += bytes.substr(at, count);
        at += count;
    }
    return raw(static_cast<uint32_t>(packed.size())) + raw(static_cast<uint32_t>(bytes.size())) + packed;
}

void add(const Seeds& seeds, const std::string& name, const Cloud& cloud) {
    const size_t count = cloud.columns[0].size();
    const auto head = [&](const char* data) {
        return cloud.header +
               fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS {}\nDATA {}\n", cloud.width,
                           cloud.height, count, data);
    };
    std::string by_point, by_field;
    for (size_t i = 0; i < count; ++i)
        for (const auto& column : cloud.columns) by_point += column[i];
    for (const auto& column : cloud.columns)
        for (const auto& value : column) by_field += value;
    seeds.add_scan(name + "-ascii", head("ascii") + cloud.text);
    seeds.add_scan(name + "-binary", head("binary") + by_point);
    seeds.add_scan(name + "-compressed", head("binary_compressed") + compressed(by_field));
}

}  // namespace

void pcd_seeds(const Seeds& seeds) {
    add(seeds, "organised", organised());
    add(seeds, "doubles", doubles());
    seeds.add_scan(
        "lost-colour",
        "# .PCD v0.7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n"
        "1 2 3 nan\n4 5 6 2.35e-38\n");
}

}  // namespace lucarne::fuzz
