#include "tests/fuzz/fuzz_scan.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    return lucarne::io::fuzz_scan("# .PCD", data, size);
}
