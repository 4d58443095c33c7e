#include "gi/post/accumulate.h"

namespace lucarne::gi {

Result<void> accumulate(Device& device, const Buffer& sample, uint32_t pixels, uint32_t count, Buffer& mean) {
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/accumulate.comp"));
    sample.bind(0);
    mean.bind(1);
    program->set("pixels", pixels);
    program->set("count", count);
    program->dispatch(pixels);
    return {};
}

}  // namespace lucarne::gi
