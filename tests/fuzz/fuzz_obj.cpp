#include "tests/fuzz/fuzz_scan.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    return scan("v 0 ", data, size);
}
