#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "gi/bake/host_cut.h"
#include "gi/shared/surfel_code.h"
#include "gi/volume/surfel_voxels.h"
#include "gi/volume/triangles/areas.h"
#include "gi/volume/triangles/raster_voxels.h"
#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/formats/load_mesh.h"
#include "octree/stream/cut.h"
#include "octree/tree/robust_bounds.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"

namespace lucarne::viewer {
namespace {

using gi::volume::OccupiedVoxel, gi::volume::VoxelSet;

enum class Method : uint8_t { automatic, area, geometry, slices, surfels };

struct VoxelizeOptions {
    InputOptions input;
    Method method = Method::automatic;
    uint32_t grid = 128, vertices = 0;
    uint32_t bits = 32;
    std::string points = "4M", memory = "2G", output, json;
    bool overwrite = false;
};

Result<VoxelSet> voxels_of_mesh(const VoxelizeOptions& options, const io::mesh::Mesh& mesh) {
    LUCARNE_ASSIGN(const auto triangles,
                   gi::volume::MeshTriangles::create(mesh, options.input.read.metres_per_unit.value_or(1),
                                                     options.grid));
    if (options.method == Method::automatic || options.method == Method::area)
        return gi::volume::areas_of_triangles(triangles);
    LUCARNE_ASSIGN(const uint64_t memory, parse_bytes("--device-memory", options.memory));
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    device->set_memory_cap(memory);
    const auto slicing =
        options.method == Method::geometry ? gi::volume::Slicing::cut : gi::volume::Slicing::discard;
    return gi::volume::rasterize_triangles(
        *device, triangles, {.slicing = slicing, .vertices = options.vertices, .bits = options.bits});
}

/// Takes as many points as --points allows, evenly from the whole scan.
Result<VoxelSet> voxels_of_points(const VoxelizeOptions& options) {
    LUCARNE_ASSIGN(const uint64_t points, parse_count("--points", options.points));
    LUCARNE_ASSIGN(const auto source, open_input(options.input));
    const auto bounds = octree::robust_bounds(*source);
    const glm::dvec3 middle = (bounds[0] + bounds[1]) / 2.0;
    gi::Scene scene;
    scene.materials.resize(1);
    const gi::SurfelPreparation preparation(source, scene);
    const double unit = source->header().metres_per_unit;
    const octree::Cut cut =
        octree::light_cut(*source, middle, points, {}, glm::distance(bounds[0], bounds[1]));
    LUCARNE_ASSIGN(const gi::HostCut surfels,
                   gi::load_host_cut(*source, cut, gi::local_frame(middle, unit), preparation));
    return gi::volume::voxels_of_surfels(surfels.surfels, options.grid, surfels.frame.origin * unit);
}

Result<VoxelSet> voxels_of_input(const VoxelizeOptions& options) {
    if (options.method == Method::surfels) return voxels_of_points(options);
    const bool any = options.method == Method::automatic;
    const std::string& path = options.input.paths.front();
    if (options.input.paths.size() == 1 && !options.input.read.mesh.vertices) {
        LUCARNE_ASSIGN(const io::mesh::Mesh mesh, io::load_mesh(path, options.input.read));
        if (!mesh.triangles.empty()) return voxels_of_mesh(options, mesh);
    }
    if (any) return voxels_of_points(options);
    return bad_arguments(options.input.paths.size() == 1 ? path : "several inputs",
                         "there are no triangles to draw into voxels",
                         "give one OBJ or PLY mesh, or choose --by surfels");
}

io::Schema voxel_schema() {
    io::Schema schema;
    schema.add(std::string(io::names::normal), io::ScalarType::f32, 3);
    schema.add(std::string(io::names::color), io::ScalarType::u8, 3);
    schema.add("voxel_area", io::ScalarType::f32);
    return schema;
}

/// Writes the middles of the voxels as points, with the mean normal, the albedo (sRGB) and the area, m^2.
Result<void> write_voxels(const VoxelSet& set, const std::string& path, bool overwrite) {
    const io::Schema schema = voxel_schema();
    LUCARNE_ASSIGN(
        const auto writer,
        io::create_scan(path, schema, {}, {.overwrite = overwrite, .expected_points = set.voxels.size()}));
    constexpr size_t kVoxelsAtOnce = 1 << 16;
    std::vector<std::byte> records;
    for (size_t first = 0; first < set.voxels.size(); first += kVoxelsAtOnce) {
        const size_t count = std::min(kVoxelsAtOnce, set.voxels.size() - first);
        records.assign(count * schema.stride, std::byte{0});
        for (size_t i = 0; i < count; ++i) {
            const OccupiedVoxel& voxel = set.voxels[first + i];
            std::byte* at = records.data() + i * schema.stride;
            io::store(at, set.middle(voxel));
            io::store(at + schema.attributes[0].offset, voxel.normal);
            for (int channel = 0; channel < 3; ++channel)
                at[schema.attributes[1].offset + static_cast<uint32_t>(channel)] = static_cast<std::byte>(
                    std::lround(255 * gi::linear_to_srgb(glm::clamp(voxel.albedo[channel], 0.0f, 1.0f))));
            io::store(at + schema.attributes[2].offset, voxel.area);
        }
        LUCARNE_TRY(writer->write(records));
    }
    return writer->finish();
}

Result<void> voxelize(const VoxelizeOptions& options) {
    LUCARNE_TRY(check_outputs({options.output, options.json}, options.overwrite, options.input.paths));
    if (options.vertices != 0 && options.method != Method::geometry && options.method != Method::slices)
        return bad_arguments("--vertex-limit", "is for --by geometry and --by slices");
    const auto start = std::chrono::steady_clock::now();
    LUCARNE_ASSIGN(const VoxelSet set, voxels_of_input(options));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    LUCARNE_TRY(write_voxels(set, options.output, options.overwrite));
    const gi::volume::Grid& grid = set.grid;
    if (!options.json.empty()) {
        const nlohmann::json report = {{"grid", {grid.size.x, grid.size.y, grid.size.z}},
                                       {"voxel", grid.voxel},
                                       {"voxels", set.voxels.size()},
                                       {"area", set.area()},
                                       {"seconds", seconds}};
        LUCARNE_TRY(write_file(options.json, json_text(report), options.overwrite));
    }
    log::info("{}: {} of {}x{}x{}, {:.3g} m a side, {:.6g} m2 of surface, {:.2f} s", options.output,
              counted(set.voxels.size(), "voxels"), grid.size.x, grid.size.y, grid.size.z, grid.voxel,
              set.area(), seconds);
    return {};
}

}  // namespace

void add_voxelize(CommandLine& line) {
    auto options = std::make_shared<VoxelizeOptions>();
    Arguments command = line.add("voxelize", "Find the voxels that a mesh or scan occupies");
    add_input_options(command, options->input);
    command
        .add("-o,--output", options->output,
             "Where to write the voxels' middles as points, with normal, colour and area (voxel_area, m2): "
             ".ply, or another format of scans")
        .required()
        .type_name("FILE");
    command.add("--grid", options->grid, "Voxels along the longest side")
        .range(1u, gi::volume::kMostMeshVoxels)
        .show_default()
        .type_name("N");
    command.choice(
        "--by", options->method,
        {{"area", Method::area},
         {"geometry", Method::geometry},
         {"slices", Method::slices},
         {"surfels", Method::surfels}},
        "How: every voxel that a triangle meets, with exact areas (default for meshes); triangles drawn "
        "along the axis of their largest area, cut into slices by a geometry shader, or drawn into each "
        "slice and clipped there; the discs of points (default for scans)");
    command
        .add("--vertex-limit", options->vertices,
             "With geometry or slices: vertices that the geometry shader emits for a triangle at most; what "
             "does not fit is missing (default: nothing is missing)")
        .range(3u, gi::volume::kMostEmitted)
        .type_name("N");
    command.add("--bits", options->bits, "With geometry or slices: bits of a float in the volume")
        .one_of({16, 32})
        .show_default()
        .type_name("16|32");
    command
        .add("--device-memory", options->memory,
             "With geometry or slices: memory of the device to use at most")
        .show_default()
        .type_name("BYTES[k|M|G]");
    command.add("--points", options->points, "With surfels: how many points of the scan to take at most")
        .show_default()
        .type_name("N[k|M|G]");
    command.add("--json", options->json, "Write size and numbers as JSON").type_name("FILE");
    command.flag("--overwrite", options->overwrite, "Replace outputs that exist");
    command.run([options] { return voxelize(*options); });
}

}  // namespace lucarne::viewer
