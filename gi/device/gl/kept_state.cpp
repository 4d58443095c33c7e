#include "gi/device/gl/kept_state.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace lucarne::gi {
namespace {

constexpr std::array<GLenum, 10> kCapabilities = {GL_CULL_FACE,           GL_DEPTH_TEST,
                                                  GL_STENCIL_TEST,        GL_RASTERIZER_DISCARD,
                                                  GL_COLOR_LOGIC_OP,      GL_SAMPLE_ALPHA_TO_COVERAGE,
                                                  GL_SAMPLE_COVERAGE,     GL_SAMPLE_MASK,
                                                  GL_POLYGON_OFFSET_FILL, GL_FRAMEBUFFER_SRGB};
constexpr std::array<GLenum, 6> kBlendState = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA,
                                               GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
                                               GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA};

void enable(GLenum capability, bool on) {
    if (on)
        glEnable(capability);
    else
        glDisable(capability);
}

}  // namespace

KeptState::KeptState(uint32_t targets) : targets_(std::min(targets, kMostTargets)) {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer_);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
    glGetIntegerv(GL_CURRENT_PROGRAM, &program_);
    GLint modes[2] = {GL_FILL, GL_FILL};  // older drivers return one for each side
    glGetIntegerv(GL_POLYGON_MODE, modes);
    polygon_mode_ = modes[0];
    glGetFloati_v(GL_VIEWPORT, 0, viewport_.data());
    for (size_t i = 0; i < kCapabilities.size(); ++i) on_[i] = glIsEnabled(kCapabilities[i]) == GL_TRUE;
    scissor_ = glIsEnabledi(GL_SCISSOR_TEST, 0) == GL_TRUE;
    for (GLuint i = 0; i < targets_; ++i) {
        kept_[i].blend = glIsEnabledi(GL_BLEND, i) == GL_TRUE;
        for (size_t k = 0; k < kBlendState.size(); ++k) glGetIntegeri_v(kBlendState[k], i, &kept_[i].how[k]);
        glGetBooleani_v(GL_COLOR_WRITEMASK, i, kept_[i].mask.data());
        glColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    for (const GLenum capability : kCapabilities) glDisable(capability);
    glDisablei(GL_SCISSOR_TEST, 0);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

KeptState::~KeptState() {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(framebuffer_));
    glBindVertexArray(static_cast<GLuint>(vertex_array_));
    glUseProgram(static_cast<GLuint>(program_));
    glPolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_));
    glViewportIndexedfv(0, viewport_.data());
    for (size_t i = 0; i < kCapabilities.size(); ++i) enable(kCapabilities[i], on_[i]);
    if (scissor_) glEnablei(GL_SCISSOR_TEST, 0);
    for (GLuint i = 0; i < targets_; ++i) {
        const auto of = [&](size_t k) { return static_cast<GLenum>(kept_[i].how[k]); };
        glBlendEquationSeparatei(i, of(0), of(1));
        glBlendFuncSeparatei(i, of(2), of(3), of(4), of(5));
        if (kept_[i].blend)
            glEnablei(GL_BLEND, i);
        else
            glDisablei(GL_BLEND, i);
        const auto& mask = kept_[i].mask;
        glColorMaski(i, mask[0], mask[1], mask[2], mask[3]);
    }
}

}  // namespace lucarne::gi
