// How fast scan files are decoded, beside the targets: `bench_formats [FOLDER]`, which needs 1 GB.
#include "tests/bench/formats.h"

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : std::filesystem::temp_directory_path();
    const auto done = lucarne::bench::bench_formats(folder);
    if (!done) fmt::print(stderr, "bench_formats: {}\n", done.error().line());
    return done ? 0 : 1;
}
