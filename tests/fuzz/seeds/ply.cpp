// Makes PLY in its three encodings, with everything that may stand before, in and after the vertices.
#include <algorithm>

#include <fmt/format.h>

#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {
namespace {

template <class T>
std::string raw(T value, bool big_endian) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

std::string head(const char* encoding) {
    return fmt::format(
        "ply\nformat {} 1.0\ncomment lucarne station 1 0.5 2 3\nobj_info a scanner\nelement camera "
        "1\nproperty float "
        "view\nelement vertex 3\nproperty double x\nproperty float y\nproperty int z\nproperty uchar "
        "red\nproperty "
        "uchar green\nproperty uchar blue\nproperty list uchar short around\nproperty float nx\nproperty "
        "float "
        "ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
        encoding);
}

std::string binary(bool big) {
    std::string bytes = raw(1.5f, big);
    for (int i = 0; i < 3; ++i) {
        bytes += raw(0.25 * i, big) + raw(-1.5f, big) + raw(i, big) + "\x10\x20\x30";
        bytes += std::string(1, '\2') + raw(int16_t{7}, big) + raw(int16_t{-7}, big);
        bytes += raw(0.f, big) + raw(0.f, big) + raw(1.f, big);
    }
    return bytes + '\3' + raw(0, big) + raw(1, big) + raw(2, big);
}

}  // namespace

void ply_seeds(const Seeds& seeds) {
    seeds.add_scan("ascii", head("ascii") +
                                "1.5\n0 -1.5 0 16 32 48 2 7 -7 0 0 1\n0.25 -1.5 1 16 32 48 0 0 0 1\n" +
                                "5e-1 -1.5 2 16 32 48 1 3 0 0 1\n3 0 1 2\n");
    seeds.add_scan("little-endian", head("binary_little_endian") + binary(false));
    seeds.add_scan("big-endian", head("binary_big_endian") + binary(true));
    seeds.add_scan(
        "textured",
        "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty "
        "float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
        "blue\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float "
        "texcoord\nproperty int texnumber\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n"
        "0 1 1 1 2 3\n3 0 1 2 6 0 0 1 0 1 1 0\n4 0 1 2 3 0 0\n");
    std::string mesh =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float "
        "y\nproperty float "
        "z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int "
        "vertex_index\nproperty uchar "
        "red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (int i = 0; i < 4; ++i) {
        const float x = i == 1 || i == 2, y = i > 1;
        mesh += raw(x, false) + raw(y, false) + raw(0.f, false) + raw(x, false) + raw(y, false);
    }
    mesh += '\4' + raw(0, false) + raw(1, false) + raw(2, false) + raw(3, false) + "abc";
    seeds.add_scan("mesh", mesh);
    seeds.add_scan("flat",
                   "ply\rformat ascii 1.0\relement vertex 2\rproperty float32 x\rproperty float32 y\r"
                   "end_header\r1 2\r3 4\r");
}

}  // namespace lucarne::fuzz
