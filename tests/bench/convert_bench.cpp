// Measures the cost of a conversion: `bench_convert [FOLDER] [--scale S]` converts the survey of 20M points
// without and with normals and prints each stage's share, CPU time, memory, bytes a point and the time to
// load a point beside their targets, which follow the scale.
#include "tests/bench/conversion.h"

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::bench_conversion);
}
