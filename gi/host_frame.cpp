#include "gi/host_frame.h"

#include <cassert>

#include "gi/gl_frame.h"

namespace lucarne::gi {

std::vector<Surfel> download_light_surfels(const Frame& frame) {
    assert(frame.gl.cuts.light);
    return frame.gl.pool.download(*frame.gl.cuts.light);
}

std::vector<GBufferTexel> download_gbuffer(const Frame& frame) {
    const GBuffer& gbuffer = frame.gl.gbuffer;
    return gbuffer.texels.download_all<GBufferTexel>(size_t{gbuffer.width} * gbuffer.height);
}

void upload_radiance(Frame& frame, std::span<const glm::vec4> radiance) {
    assert(radiance.size() == size_t{frame.gl.gbuffer.width} * frame.gl.gbuffer.height);
    frame.gl.radiance.upload(0, std::as_bytes(radiance));
}

TimedPass::TimedPass(Frame& frame, const char* name) : times_(frame.times) {
    times_.begin(name);
}

TimedPass::~TimedPass() {
    times_.end();
}

}  // namespace lucarne::gi
