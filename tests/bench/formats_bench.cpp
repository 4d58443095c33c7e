// How fast scan files are decoded, beside the targets: `bench_formats [FOLDER] [--scale S]`, which needs 1
// GB.
#include "tests/bench/formats.h"

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::bench::bench_formats);
}
