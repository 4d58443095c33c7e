// Sets the dots per inch in the X server's resources, as a desktop does for a high-resolution screen.
// Programs that start later read them.
//   set_dpi DPI     96: the usual scale of 1
#include <cstdio>
#include <string>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("usage: set_dpi DPI\n", stderr);
        return 2;
    }
    Display* display = XOpenDisplay(nullptr);
    if (!display) {
        std::fputs("no display\n", stderr);
        return 1;
    }
    const std::string resources = "Xft.dpi:\t" + std::string(arguments[1]) + "\n";
    XChangeProperty(display, DefaultRootWindow(display), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(resources.data()),
                    static_cast<int>(resources.size()));
    XCloseDisplay(display);
}
