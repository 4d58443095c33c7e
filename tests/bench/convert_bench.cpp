// What a conversion costs: `bench_convert [POINTS] [FOLDER]` converts the survey without and with normals and
// prints each stage's share, CPU time, memory, bytes a point and the time to load a point beside their
// targets, which are scaled from 20 million points, the default.
#include "io/core/options.h"
#include "tests/bench/conversion.h"

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path();
    const auto points = lucarne::parse_count("POINTS", argc > 1 ? argv[1] : "20M");
    const auto done = points ? lucarne::bench_conversion(folder, *points)
                             : lucarne::Result<void>(tl::make_unexpected(points.error()));
    if (!done) fmt::print(stderr, "bench_convert: {}\n", done.error().line());
    return done ? 0 : 1;
}
