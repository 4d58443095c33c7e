#include "gi/device/gl/egl.h"

#include <array>
#include <string>
#include <vector>

#include <epoxy/egl.h>
#include <fmt/format.h>

namespace lucarne::gi {
namespace {

constexpr const char* kTodo =
    "install Mesa's drivers (libegl-mesa0, libgl1-mesa-dri) or a graphics driver with OpenGL 4.5";

/// Returns the displays worth trying, best first.
std::vector<EGLDisplay> displays() {
    std::vector<EGLDisplay> found;
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base")) return found;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) count = 0;
        for (EGLint i = 0; i < count; ++i) {
            const char* text = eglQueryDeviceStringEXT(devices[static_cast<size_t>(i)], EGL_EXTENSIONS);
            const std::string_view extensions = text ? text : "";
            if (extensions.find("EGL_MESA_device_software") != std::string_view::npos) continue;
            found.push_back(
                eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<size_t>(i)], nullptr));
        }
    }
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        found.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return found;
}

/// Creates a context on `display` and makes it current. On failure returns EGL_NO_CONTEXT and sets `why`.
EGLContext make_current_context(EGLDisplay display, std::string& why) {
    EGLint major = 0, minor = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) {
        why = fmt::format("EGL does not start (error {:#x})", eglGetError());
        return EGL_NO_CONTEXT;
    }
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") || !eglBindAPI(EGL_OPENGL_API)) {
        why = "no OpenGL without a window";
        return EGL_NO_CONTEXT;
    }
    constexpr std::array<EGLint, 5> kConfig = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                               EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    if (!eglChooseConfig(display, kConfig.data(), &config, 1, &configs) || configs < 1) {
        why = "no OpenGL configuration";
        return EGL_NO_CONTEXT;
    }
#ifdef NDEBUG
    constexpr EGLint kDebug = EGL_FALSE;
#else
    constexpr EGLint kDebug = EGL_TRUE;
#endif
    // The last pair asks the driver to report resets (EGL 1.5, 3.7.1). Drivers that cannot do so refuse it.
    std::array<EGLint, 11> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         5,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_CONTEXT_OPENGL_DEBUG,
                                         kDebug,
                                         EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                         EGL_LOSE_CONTEXT_ON_RESET,
                                         EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) {
        attributes[8] = EGL_NONE;
        context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
    }
    if (context == EGL_NO_CONTEXT) {
        why = "OpenGL is older than 4.5";
        return EGL_NO_CONTEXT;
    }
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        why = fmt::format("the context cannot be made current (EGL error {:#x})", eglGetError());
        eglDestroyContext(display, context);
        return EGL_NO_CONTEXT;
    }
    return context;
}

}  // namespace

Result<std::unique_ptr<HeadlessContext>> HeadlessContext::create() {
    // libepoxy aborts if libEGL itself is missing, so check first.
    if (!epoxy_has_egl()) return failed("OpenGL", "no usable device: the EGL library is missing", kTodo);
    std::string why = "EGL has no platform that works without a window";
    for (EGLDisplay display : displays()) {
        EGLContext context = make_current_context(display, why);
        if (context != EGL_NO_CONTEXT)
            return std::unique_ptr<HeadlessContext>(new HeadlessContext(display, context));
    }
    return failed("OpenGL", "no usable device: " + why, kTodo);
}

HeadlessContext::~HeadlessContext() {
    if (eglGetCurrentContext() == context_)
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    // The display stays open: EGL hands the same one to every context of the process.
}

}  // namespace lucarne::gi
