#include "gi/scene/scene.h"
#include "tests/fuzz/fuzz.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    (void)gi::parse_scene({reinterpret_cast<const char*>(data), size}, "fuzz", "/nonexistent");
    return true;
}
