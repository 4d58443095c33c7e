#include "tests/fuzz/fuzz_scan.h"

/// XYZ, PTS and PTX; the content tells which.
bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    return scan("", data, size);
}
