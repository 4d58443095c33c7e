#include "tests/fuzz/fuzz_scan.h"

/// XYZ, PTS and PTX, as their content tells.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    return lucarne::io::fuzz_scan("", data, size);
}
