// What a conversion costs: a LAS file of the nave with --memory 1G, first without normals, then a part of it
// with. Prints CPU-seconds of each stage and the peak of resident memory beside the targets. Takes the number
// of points, 20 million unless told.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <sys/resource.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/progress.h"
#include "io/formats/scan.h"
#include "io/synthetic/synthetic.h"
#include "octree/build/build.h"

namespace lucarne {
namespace {

Result<void> write_nave(const std::filesystem::path& path, uint64_t points) {
    io::SyntheticOptions options;
    options.scene = "nave";
    options.points = points;
    LUCARNE_ASSIGN(const auto source, io::synthetic_source(options));
    LUCARNE_ASSIGN(const auto writer,
                   io::create_scan(path, source->schema(), source->info(), {.overwrite = true}));
    LUCARNE_ASSIGN(const auto reader, source->open());
    io::PointBatch batch;
    for (;;) {
        LUCARNE_ASSIGN(const size_t count, reader->read(batch, 1 << 17));
        if (count == 0) return writer->finish();
        LUCARNE_TRY(writer->write(batch.bytes));
    }
}

Result<void> measure(const std::filesystem::path& scan, octree::NormalsMode normals, const char* target) {
    LUCARNE_ASSIGN(const auto source, io::open_scan(scan));
    octree::BuildOptions options{
        .inputs = {source.get()}, .output = scan.string() + ".luc", .normals = normals};
    options.memory = uint64_t{1} << 30;
    options.overwrite = true;
    LUCARNE_ASSIGN(const auto report, octree::build_cache(options));
    double cpu = 0, wall = 0;
    for (const auto& stage : report.stages) {
        fmt::print("  {:<8}{:8.2f} CPU-s {:8.2f} s\n", stage.name, stage.cpu_seconds, stage.wall_seconds);
        cpu += stage.cpu_seconds;
        wall += stage.wall_seconds;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("{:.1f}M points: {:.2f} CPU-s ({:.2f} a million), {:.2f} s, {} on disk, peak {}; {}\n",
               1e-6 * static_cast<double>(report.points), cpu, 1e6 * cpu / static_cast<double>(report.points),
               wall, bytes_text(report.bytes), bytes_text(static_cast<uint64_t>(usage.ru_maxrss) << 10),
               target);
    return {};
}

Result<void> bench(uint64_t points) {
    const auto folder = std::filesystem::temp_directory_path() / fmt::format("lucarne-bench-{}", points);
    std::filesystem::create_directories(folder);
    const auto run = [&]() -> Result<void> {
        LUCARNE_TRY(write_nave(folder / "all.las", points));
        LUCARNE_TRY(
            measure(folder / "all.las", octree::NormalsMode::none, "target: 26 CPU-s for 20M under 1 GiB"));
        LUCARNE_TRY(write_nave(folder / "part.las", points / 10));
        return measure(folder / "part.las", octree::NormalsMode::estimate,
                       "target: 5 CPU-s a million for normals");
    };
    auto done = run();
    std::filesystem::remove_all(folder);
    return done;
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    lucarne::Progress::set_silent(true);
    const auto points = lucarne::parse_count("points", argc > 1 ? argv[1] : "20M");
    const auto done =
        points ? lucarne::bench(*points) : lucarne::Result<void>(tl::make_unexpected(points.error()));
    if (!done) std::fprintf(stderr, "%s\n", done.error().line().c_str());
    return done ? 0 : 1;
}
