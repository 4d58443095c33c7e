#include "gi/volume/triangles/raster_voxels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "gi/device/gl/layered_target.h"
#include "gi/shared/surfel_code.h"
#include "gi/volume/triangles/bindings.h"
#include "gi/volume/voxel_sums.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kTrianglesABatch = size_t{1} << 18, kTrianglesPacked = 4096;
/// Vertices without a limit: the largest numbers of the thesis' table 3.
constexpr uint32_t kVerticesOfCuts = 19, kVerticesOfCopies = 15;
/// Cells that are looked at, at once, for occupied ones.
constexpr uint32_t kCellsAtOnce = 1u << 18;
/// Triangles whose area along an axis is less than this share of their largest are not swept along it,
/// whatever the rounding.
constexpr double kSurelyOther = 0.99;

using PackedCorner = std::array<uint32_t, 4>;

/// Some triangles in the layout of corners.vert.
struct PackedTriangles {
    std::vector<PackedCorner> corners;
    std::array<int, 3> slices{};  ///< the most that a triangle meets along each axis
};

PackedTriangles pack(const MeshTriangles& triangles, size_t first, size_t count) {
    PackedTriangles packed{std::vector<PackedCorner>(3 * count), {}};
    std::vector<std::array<int, 3>> slices((count + kTrianglesPacked - 1) / kTrianglesPacked,
                                           std::array<int, 3>{});
    parallel_ranges(count, kTrianglesPacked, [&](size_t begin, size_t end) {
        auto& most = slices[begin / kTrianglesPacked];
        for (size_t i = begin; i < end; ++i) {
            const GridTriangle triangle = triangles[first + i];
            for (size_t k = 0; k < 3; ++k) {
                const glm::vec3 place(triangle.corners[k]);
                packed.corners[3 * i + k] = {
                    std::bit_cast<uint32_t>(place.x), std::bit_cast<uint32_t>(place.y),
                    std::bit_cast<uint32_t>(place.z), encode_albedo(triangle.albedo[k])};
            }
            const glm::dvec3 normal = glm::abs(triangle.cross());
            const double largest = std::max({normal.x, normal.y, normal.z});
            const auto [a, b, c] = triangle.corners;
            const glm::dvec3 low = glm::floor(glm::min(a, glm::min(b, c))),
                             high = glm::floor(glm::max(a, glm::max(b, c)));
            for (int axis = 0; axis < 3; ++axis)
                if (normal[axis] >= kSurelyOther * largest)
                    // One more: places are rounded to floats.
                    most[static_cast<size_t>(axis)] = std::max(most[static_cast<size_t>(axis)],
                                                               static_cast<int>(high[axis] - low[axis]) + 2);
        }
    });
    for (const auto& most : slices)
        for (size_t axis = 0; axis < 3; ++axis)
            packed.slices[axis] = std::max(packed.slices[axis], most[axis]);
    return packed;
}

/// The sweeps along the three axes.
class Sweeps {
 public:
    Sweeps(Device& device, const MeshTriangles& triangles, const RasterVoxelOptions& options)
        : device_(device), triangles_(triangles), options_(options) {
        attributes_.push_back({1, options.bits});
        if (options.albedo) attributes_.push_back({4, options.bits});
        if (options.normals) attributes_.push_back({4, options.bits});
        if (options.albedo) outputs_.emplace_back("LUCARNE_ALBEDO", "1");
        if (options.normals) outputs_.emplace_back("LUCARNE_NORMAL", "1");
    }

    Result<void> prepare() {
        const bool cuts = options_.slicing == Slicing::cut;
        const uint32_t vertices = options_.vertices ? options_.vertices
                                  : cuts            ? kVerticesOfCuts
                                                    : kVerticesOfCopies;
        // Without a limit every triangle is drawn so often that no vertex is missing.
        slices_a_draw_ = options_.vertices
                             ? triangles_.grid().size.x + triangles_.grid().size.y + triangles_.grid().size.z
                         : cuts ? (static_cast<int>(vertices) - 4) / 4
                                : static_cast<int>(vertices) / 3;
        Defines defines = outputs_;
        defines.emplace_back("VERTICES", std::to_string(vertices));
        if (!cuts) defines.emplace_back("LUCARNE_DISCARD", "1");
        const RasterShaders shaders{
            "gi/volume/triangles/corners.vert",
            cuts ? "gi/volume/triangles/slice.geom" : "gi/volume/triangles/repeat.geom",
            "gi/volume/triangles/voxel.frag"};
        LUCARNE_ASSIGN(program_, device_.raster_program(shaders, defines));
        LUCARNE_ASSIGN(collect_, device_.program("gi/volume/triangles/collect.comp", outputs_));
        const size_t most = std::min(triangles_.count(), kTrianglesABatch);
        LUCARNE_ASSIGN(corners_, device_.texels(3 * most * sizeof(PackedCorner), "triangles"));
        LUCARNE_ASSIGN(count_, device_.buffer(sizeof(uint32_t), "number of voxels"));
        return {};
    }

    /// Draws the triangles of one axis and adds their voxels to the sums.
    Result<void> sweep(int axis, VoxelSums& sums) {
        const glm::ivec3 grid = triangles_.grid().size;
        const glm::ivec3 size(grid[(axis + 1) % 3], grid[(axis + 2) % 3], grid[axis]);
        LUCARNE_ASSIGN(LayeredTarget target, LayeredTarget::create(device_, size, attributes_, "voxels"));
        target.clear();
        const std::array extent = {static_cast<float>(size.x), static_cast<float>(size.y),
                                   static_cast<float>(size.z)};
        program_->set_block("grid_size", extent);
        program_->set("axis", axis);
        program_->set("slice_count", slices_a_draw_);
        for (size_t first = 0; first < triangles_.count(); first += kTrianglesABatch) {
            const size_t count = std::min(kTrianglesABatch, triangles_.count() - first);
            const PackedTriangles packed = pack(triangles_, first, count);
            corners_.upload_all(packed.corners);
            corners_.bind_texels(kUnitCorners, TexelView::four_words);
            const int slices = options_.vertices ? 1 : packed.slices[static_cast<size_t>(axis)];
            for (int slice = 0; slice < slices; slice += slices_a_draw_) {
                program_->set("first_slice", slice);
                target.draw(*program_, 0, static_cast<uint32_t>(3 * count));
            }
        }
        return collect(axis, target, sums);
    }

 private:
    Result<void> collect(int axis, const LayeredTarget& target, VoxelSums& sums) {
        const glm::uvec3 size(target.size());
        const uint32_t layer = size.x * size.y, at_once = std::max(1u, kCellsAtOnce / layer);
        LUCARNE_TRY(device_.reserve(found_, size_t{at_once} * layer * sizeof(FoundVoxel), "found voxels"));
        collect_->set("axis", axis);
        collect_->set("across", uint32_t{size.x});
        collect_->set("down", uint32_t{size.y});
        collect_->set("grid_width", static_cast<uint32_t>(triangles_.grid().size.x));
        collect_->set("grid_height", static_cast<uint32_t>(triangles_.grid().size.y));
        std::vector<VoxelPart> parts;
        for (uint32_t first = 0; first < size.z; first += at_once) {
            const uint32_t layers = std::min(at_once, size.z - first);
            collect_->set("first_layer", first);
            collect_->set("layer_count", layers);
            count_.clear(0);
            target.bind_texture(0, kUnitCoverage);
            if (options_.albedo) target.bind_texture(1, kUnitAlbedo);
            if (options_.normals) target.bind_texture(options_.albedo ? 2 : 1, kUnitNormal);
            found_.bind(kBindFound);
            count_.bind(kBindCount);
            collect_->dispatch(layer * layers);
            for (const FoundVoxel& v : found_.download_all<FoundVoxel>(count_.download_all<uint32_t>(1)[0]))
                parts.push_back({v.cell, v.area, glm::vec3(v.normal_x, v.normal_y, v.normal_z),
                                 glm::vec3(v.red, v.green, v.blue)});
        }
        sums.add(parts);
        return {};
    }

    Device& device_;
    const MeshTriangles& triangles_;
    const RasterVoxelOptions& options_;
    std::vector<TargetAttribute> attributes_;
    Defines outputs_;
    int slices_a_draw_ = 1;
    const RasterProgram* program_ = nullptr;
    const Program* collect_ = nullptr;
    Buffer corners_, found_, count_;
};

}  // namespace

Result<VoxelSet> rasterize_triangles(Device& device, const MeshTriangles& triangles,
                                     const RasterVoxelOptions& options) {
    Sweeps sweeps(device, triangles, options);
    LUCARNE_TRY(sweeps.prepare());
    VoxelSums sums;
    for (int axis = 0; axis < 3; ++axis) LUCARNE_TRY(sweeps.sweep(axis, sums));
    LUCARNE_TRY(device.check());
    return sums.means(triangles.grid(), triangles.origin());
}

}  // namespace lucarne::gi::volume
