#pragma once

#include <memory>

#include "io/core/error.h"

namespace lucarne::gi {

/// An OpenGL 4.5 core context without a window, current on this thread. The destructor makes it no longer
/// current.
class HeadlessContext {
 public:
    /// Tries hardware first (EGL_EXT_platform_device), then Mesa's surfaceless platform, which always has
    /// llvmpipe. Errors: no EGL, or no device with OpenGL 4.5.
    static Result<std::unique_ptr<HeadlessContext>> create();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

 private:
    HeadlessContext(void* display, void* context) : display_(display), context_(context) {}
    void* display_;  // EGLDisplay and EGLContext as void*: their header includes X11's macros
    void* context_;
};

}  // namespace lucarne::gi
