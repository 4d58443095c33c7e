#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "io/image/image.h"
#include "tests/io/formats/scan_text.h"

// Shared by the tests of meshes: options, a square, a folder of files with a picture.
namespace lucarne::io::testing {

inline ReadOptions every(double spacing) {
    return {"", true, {spacing, 0, false}};
}
inline ReadOptions about(uint64_t samples) {
    return {"", true, {0, samples, false}};
}
inline const ReadOptions kVertices{"", true, {0, 0, true}};

inline const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

class MeshScan : public TextScan {
 protected:
    std::vector<glm::dvec3> positions() const {
        std::vector<glm::dvec3> all;
        for (size_t i = 0; i < points(); ++i) all.push_back(position(i));
        return all;
    }
    glm::dvec3 triple(size_t i, std::string_view name) const {
        return {value(i, name, 0), value(i, name, 1), value(i, name, 2)};
    }
    const MeshNotes& notes() const { return *source_->info().notes.mesh; }

    /// Reads an OBJ or PLY file from a folder that also holds the files it names.
    void read_folder(const std::string& name, const ReadOptions& options) {
        const auto source = open_scan(folder_ / name, options);
        ASSERT_TRUE(source) << source.error().line();
        source_ = std::move(const_cast<std::unique_ptr<PointSource>&>(*source));
        const auto records = read_all(*source_);
        ASSERT_TRUE(records) << records.error().line();
        records_ = *records;
    }
    void put(const std::string& name, const std::string& text) const { write_bytes(folder_ / name, text); }
    /// Upper half red, lower half blue; the left quarter green from top to bottom.
    void put_picture(const std::string& name) const {
        Image8 image{64, 64, {}};
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const std::array<uint8_t, 3> color = x < 16   ? std::array<uint8_t, 3>{10, 200, 30}
                                                     : y < 32 ? std::array<uint8_t, 3>{201, 11, 12}
                                                              : std::array<uint8_t, 3>{13, 14, 203};
                image.bytes.insert(image.bytes.end(), color.begin(), color.end());
            }
        ASSERT_TRUE(write_png(folder_ / name, image, true));
    }
    /// Expects a unit square whose texture coordinates span the picture of put_picture: u along x, v along y.
    void expect_picture_upright() const {
        size_t seen = 0;
        for (size_t i = 0; i < points(); ++i) {
            const glm::dvec3 p = position(i);
            if (std::abs(p.x - 0.25) < 0.05 || std::abs(p.y - 0.5) < 0.05 || std::min(p.x, p.y) < 0.03 ||
                std::max(p.x, p.y) > 0.97)
                continue;  // between two colours
            const glm::dvec3 wanted = p.x < 0.25  ? glm::dvec3(10, 200, 30)
                                      : p.y > 0.5 ? glm::dvec3(201, 11, 12)
                                                  : glm::dvec3(13, 14, 203);
            ASSERT_EQ(triple(i, "color"), wanted) << p.x << ' ' << p.y;
            ++seen;
        }
        EXPECT_GT(seen, 500u);
    }
    const TemporaryFolder folder_;
};

}  // namespace lucarne::io::testing
