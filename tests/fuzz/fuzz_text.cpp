#include "tests/fuzz/fuzz_scan.h"

/// XYZ, PTS and PTX, as their content tells.
bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    return scan("", data, size);
}
