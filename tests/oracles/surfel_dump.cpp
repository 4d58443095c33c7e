// Writes the surfels that the renderer makes of a scan or cache, for other programs to render: see
// cycles_compare.py. Eleven little-endian floats each: position, normal, albedo, radius, area.
#include <cstdio>
#include <vector>

#include "io/files/file.h"
#include "tests/bench/all_surfels.h"

namespace lucarne {
namespace {

Result<void> dump(const char* input, const char* output) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto surfels, bench::all_surfels(*device, input));
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
