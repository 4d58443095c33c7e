#include "io/image/image.h"
#include "tests/fuzz/fuzz.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    const auto path = memory_file(data, size);
    if (path) (void)io::read_jpeg(*path, 1 << 20);
    return path.has_value();
}
