// Writes the surfels that the renderer makes of a scan or cache, for other programs to render: see
// cycles_compare.py. Eleven little-endian floats each: position, normal, albedo, radius, area.
#include <cstdio>
#include <vector>

#include "gi/surfels/surfel_pool.h"
#include "io/files/file.h"
#include "octree/stream/cut.h"
#include "viewer/inputs/input.h"

namespace lucarne {
namespace {

Result<std::vector<gi::Surfel>> surfels_of(const octree::NodeSource& source) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    const octree::Cut cut = octree::full_cut(source);
    uint64_t room = 0;
    for (const auto& node : cut.nodes) room += node.count + gi::SurfelPool::kPageSurfels;
    if (room > 100'000'000) return failed("surfel_dump", "the scan is too large for this");
    LUCARNE_ASSIGN(auto pool, gi::SurfelPool::create(*device, static_cast<uint32_t>(room)));
    gi::Scene scene;
    scene.materials.resize(1);
    std::vector<gi::CutEntry> entries;
    for (const auto& node : cut.nodes) {
        LUCARNE_ASSIGN(const auto data, source.load(node.node));
        LUCARNE_ASSIGN(
            const bool fits,
            pool.load(node.node, gi::pack_surfels(source.header(), source.nodes()[node.node], data, scene)));
        if (!fits) return failed("surfel_dump", "the pool is full");
        entries.push_back({node.node, node.count});
    }
    gi::DeviceCut drawn;
    LUCARNE_TRY(pool.make_cut(*device, source, entries, glm::dvec3(0.0), drawn));
    return pool.download(drawn);
}

Result<void> dump(const char* input, const char* output) {
    LUCARNE_ASSIGN(const auto source, viewer::open_input(input));
    LUCARNE_ASSIGN(const auto surfels, surfels_of(*source));
    std::vector<float> values;
    for (const gi::Surfel& s : surfels) {
        for (const glm::vec3& v : {s.position, s.normal, s.albedo})
            values.insert(values.end(), {v.x, v.y, v.z});
        values.insert(values.end(), {s.radius, s.area});
    }
    LUCARNE_ASSIGN(auto file, OutputFile::create(output, true));
    LUCARNE_TRY(file.append({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)}));
    LUCARNE_TRY(file.commit());
    std::printf("%zu surfels\n", surfels.size());
    return {};
}

}  // namespace
}  // namespace lucarne

int main(int count, char** arguments) {
    if (count != 3) {
        std::fprintf(stderr, "usage: surfel_dump INPUT SURFELS.bin\n");
        return 2;
    }
    const auto done = lucarne::dump(arguments[1], arguments[2]);
    if (!done) std::fprintf(stderr, "%s\n", done.error().line().c_str());
    return done ? 0 : static_cast<int>(done.error().kind);
}
