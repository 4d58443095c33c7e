#include <string_view>

#include "gi/scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    (void)lucarne::gi::parse_scene({reinterpret_cast<const char*>(data), size}, "fuzz", "/nonexistent");
    return 0;
}
