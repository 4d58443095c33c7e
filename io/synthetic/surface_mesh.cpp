#include "io/synthetic/surface_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "io/files/file.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

constexpr int kAlbedoSamples = 4;        ///< along each side of the part of a cell that a vertex stands for
constexpr size_t kQuadsAtOnce = 64;      ///< of a thread
constexpr size_t kWriteBytes = 1 << 20;  ///< OutputFile has no buffer

/// The cells of a quad: columns along a row of the patch, rows across.
struct Cells {
    uint32_t columns = 1, rows = 1;
    size_t vertices() const { return size_t{columns + 1} * (rows + 1); }
};

Cells cells_of(const PatchMesh& patches, size_t quad, double step) {
    if (!albedo_varies(patches.finishes[quad])) return {};
    const glm::vec3* c = &patches.corners[4 * quad];
    const auto count = [step](float a, float b) {
        return static_cast<uint32_t>(std::max(1.0, std::ceil(std::max(a, b) / step)));
    };
    return {count(glm::length(c[1] - c[0]), glm::length(c[2] - c[3])),
            count(glm::length(c[3] - c[0]), glm::length(c[2] - c[1]))};
}

/// Returns the mean albedo of the part of a quad that is nearest to vertex (column, row) of its cells.
dvec3 mean_albedo(const PatchMesh& patches, size_t quad, const Cells& cells, uint32_t column, uint32_t row) {
    const Finish finish = patches.finishes[quad];
    const auto at = [&](double t, double s) {
        return albedo_at(finish, patches.position(quad, t, s), patches.normal(quad, t, s));
    };
    if (!albedo_varies(finish)) return at(0, 0);
    const auto place = [](uint32_t index, uint32_t count, int sample) {
        const double low = std::max(0.0, index - .5), high = std::min<double>(count, index + .5);
        return (low + (high - low) * (sample + .5) / kAlbedoSamples) / count;
    };
    dvec3 sum(0);
    for (int i = 0; i < kAlbedoSamples; ++i)
        for (int k = 0; k < kAlbedoSamples; ++k)
            sum += at(place(column, cells.columns, i), place(row, cells.rows, k));
    return sum / static_cast<double>(kAlbedoSamples * kAlbedoSamples);
}

void put_vertices(const PatchMesh& patches, size_t quad, const Cells& cells, SurfaceMesh::Vertex* out) {
    for (uint32_t row = 0; row <= cells.rows; ++row)
        for (uint32_t column = 0; column <= cells.columns; ++column, ++out) {
            const double t = static_cast<double>(column) / cells.columns,
                         s = static_cast<double>(row) / cells.rows;
            out->position = patches.position(quad, t, s);
            out->normal = patches.normal(quad, t, s);
            const dvec3 albedo = mean_albedo(patches, quad, cells, column, row);
            for (glm::length_t c = 0; c < 3; ++c) out->albedo[static_cast<size_t>(c)] = srgb_code(albedo[c]);
        }
}

void append(std::string& out, const void* data, size_t bytes) {
    out.append(static_cast<const char*>(data), bytes);
}

}  // namespace

SurfaceMesh surface_mesh(const PatchMesh& patches, double step) {
    std::vector<Cells> cells;
    std::vector<size_t> first = {0};
    for (size_t quad = 0; quad < patches.quads(); ++quad) {
        cells.push_back(cells_of(patches, quad, step));
        first.push_back(first.back() + cells.back().vertices());
    }
    SurfaceMesh mesh;
    mesh.vertices.resize(first.back());
    parallel_ranges(patches.quads(), kQuadsAtOnce, [&](size_t begin, size_t end) {
        for (size_t quad = begin; quad < end; ++quad)
            put_vertices(patches, quad, cells[quad], &mesh.vertices[first[quad]]);
    });
    const auto add = [&mesh](uint32_t a, uint32_t b, uint32_t c) {
        const auto &u = mesh.vertices[a], &v = mesh.vertices[b], &w = mesh.vertices[c];
        // Triangles are quads of which two corners coincide.
        if (u.position == v.position || v.position == w.position || w.position == u.position) return;
        const glm::vec3 front = cross(v.position - u.position, w.position - u.position);
        // Corners go around quads either way.
        if (dot(front, u.normal + v.normal + w.normal) < 0) std::swap(b, c);
        mesh.triangles.push_back({a, b, c});
    };
    for (size_t quad = 0; quad < patches.quads(); ++quad) {
        const uint32_t line = cells[quad].columns + 1;
        for (uint32_t row = 0; row < cells[quad].rows; ++row)
            for (uint32_t column = 0; column + 1 < line; ++column) {
                // The diagonal is that of the ray caster's quads.
                const uint32_t corner = static_cast<uint32_t>(first[quad]) + row * line + column;
                add(corner, corner + 1, corner + line);
                add(corner + line + 1, corner + line, corner + 1);
            }
    }
    return mesh;
}

Result<void> write_surface_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, bool overwrite) {
    static_assert(std::endian::native == std::endian::little);
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, overwrite));
    std::string out = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nelement face {}\n"
        "property list uchar int vertex_indices\nend_header\n",
        mesh.vertices.size(), mesh.triangles.size());
    const auto flush = [&](size_t at_least) -> Result<void> {
        if (out.size() < at_least) return {};
        LUCARNE_TRY(file.append(out));
        out.clear();
        return {};
    };
    for (const SurfaceMesh::Vertex& vertex : mesh.vertices) {
        append(out, &vertex.position, sizeof vertex.position);
        append(out, &vertex.normal, sizeof vertex.normal);
        append(out, vertex.albedo.data(), vertex.albedo.size());
        LUCARNE_TRY(flush(kWriteBytes));
    }
    for (const auto& triangle : mesh.triangles) {
        out.push_back(3);
        append(out, triangle.data(), sizeof triangle);
        LUCARNE_TRY(flush(kWriteBytes));
    }
    LUCARNE_TRY(flush(1));
    return file.commit();
}

}  // namespace lucarne::io
