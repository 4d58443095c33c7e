// A library for LD_PRELOAD. It appends the time after each exchange of a window's buffers, in seconds of the
// monotonic clock, to the file that LUCARNE_SWAP_TIMES names. For a program that draws and shows its pictures
// in one thread these are the times of its pictures. It does not see functions that a program looks up itself
// (dlsym), as GLFW does.
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <dlfcn.h>

namespace {

template <class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

void append_time() {
    static std::FILE* const file = [] {
        const char* const name = std::getenv("LUCARNE_SWAP_TIMES");
        return name ? std::fopen(name, "ae") : nullptr;
    }();
    if (!file) return;
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    std::fprintf(file, "%lld.%09ld\n", static_cast<long long>(now.tv_sec), now.tv_nsec);
    std::fflush(file);  // the program may be killed
}

}  // namespace

// The declarations of GL/glx.h and EGL/egl.h, whose handles are pointers and an integer of their size.
extern "C" {

void glXSwapBuffers(void* display, unsigned long drawable) {
    static auto* const own = next<void(void*, unsigned long)>("glXSwapBuffers");
    if (own) own(display, drawable);
    append_time();
}

unsigned eglSwapBuffers(void* display, void* surface) {
    static auto* const own = next<unsigned(void*, void*)>("eglSwapBuffers");
    const unsigned swapped = own ? own(display, surface) : 0;
    append_time();
    return swapped;
}

}  // extern "C"
