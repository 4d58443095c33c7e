// Acts as a file manager for a window that files are dropped on: a source of X11's drag-and-drop protocol
// (XDND 5, freedesktop.org) that drops the files of its command line without a user.
//   drop_files X Y URI...     drops URIs on the window at X, Y of the screen Prints "finished" and exits with
//   0 once the window has accepted them; exits with 3 if it refuses, with 1 if there is no such window.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <poll.h>

namespace {

constexpr long kVersion = 5;
constexpr auto kPatience = std::chrono::seconds(600);

enum class Ending : int { finished = 0, nothing_there = 1, refused = 3, no_answer = 4 };

class Source {
 public:
    Source(Display* display, std::string list) : display_(display), list_(std::move(list)) {
        window_ = XCreateSimpleWindow(display_, root(), 0, 0, 1, 1, 0, 0, 0);
        // Like a file manager, offers more types than the three that fit the first message.
        const std::array<Atom, 4> types = {atom("x-special/gnome-icon-list"), atom("text/uri-list"),
                                           atom("UTF8_STRING"), atom("text/plain")};
        XChangeProperty(display_, window_, atom("XdndTypeList"), XA_ATOM, 32, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(types.data()), types.size());
        XSetSelectionOwner(display_, selection(), window_, CurrentTime);
    }
    ~Source() { XDestroyWindow(display_, window_); }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    /// Drags over the window at a place of the screen, and drops.
    Ending drop(int x, int y) {
        target_ = aware_window_at(x, y);
        if (target_ == None) return Ending::nothing_there;
        send("XdndEnter", {kVersion << 24 | 1, 0, 0, 0});
        bool accepts = false;
        for (int step = 4; step >= 0; --step) {  // the pointer comes from the right
            send("XdndPosition",
                 {0, (x + step) << 16 | y, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
            const auto status = answer("XdndStatus");
            if (!status) return Ending::no_answer;
            accepts = status->data.l[1] & 1;
        }
        if (!accepts) {
            send("XdndLeave", {0, 0, 0, 0});
            return Ending::refused;
        }
        send("XdndDrop", {0, CurrentTime, 0, 0});
        const auto finished = answer("XdndFinished");
        if (!finished) return Ending::no_answer;
        // Bit 0 means accepted; GLFW 3.3 writes the number of bytes read instead.
        return finished->data.l[1] != 0 ? Ending::finished : Ending::refused;
    }

 private:
    Window root() const { return DefaultRootWindow(display_); }
    Atom atom(const char* name) const { return XInternAtom(display_, name, False); }
    Atom selection() const { return atom("XdndSelection"); }

    bool aware(Window window) const {
        Atom type = None;
        int format = 0;
        unsigned long count = 0, left = 0;
        unsigned char* value = nullptr;
        XGetWindowProperty(display_, window, atom("XdndAware"), 0, 1, False, XA_ATOM, &type, &format, &count,
                           &left, &value);
        if (value) XFree(value);
        return type == XA_ATOM && count == 1;
    }
    /// Returns the window below the root and below the frames of a window manager.
    Window aware_window_at(int x, int y) const {
        Window from = root(), child = None;
        int inner_x = 0, inner_y = 0;
        while (XTranslateCoordinates(display_, root(), from, x, y, &inner_x, &inner_y, &child) &&
               child != None) {
            if (aware(child)) return child;
            from = child;
        }
        return None;
    }
    /// Sends a message whose first word is the source.
    void send(const char* type, const std::array<long, 4>& words) const {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = target_;
        event.xclient.message_type = atom(type);
        event.xclient.format = 32;
        event.xclient.data.l[0] = static_cast<long>(window_);
        std::copy(words.begin(), words.end(), event.xclient.data.l + 1);
        XSendEvent(display_, target_, False, NoEventMask, &event);
        XFlush(display_);
    }
    /// Waits for the next message of a type; answers requests for the list of files meanwhile.
    std::optional<XClientMessageEvent> answer(const char* type) const {
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (std::chrono::steady_clock::now() < end) {
            if (XPending(display_) == 0) {
                pollfd waits{ConnectionNumber(display_), POLLIN, 0};
                poll(&waits, 1, 1000);
                continue;
            }
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == SelectionRequest) hand_out(event.xselectionrequest);
            if (event.type == ClientMessage && event.xclient.message_type == atom(type)) return event.xclient;
        }
        return std::nullopt;
    }
    void hand_out(const XSelectionRequestEvent& request) const {
        XEvent event{};
        XSelectionEvent& notice = event.xselection;
        notice.type = SelectionNotify;
        notice.requestor = request.requestor;
        notice.selection = request.selection;
        notice.target = request.target;
        notice.time = request.time;
        if (request.target == atom("text/uri-list")) {
            notice.property = request.property;
            XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                            reinterpret_cast<const unsigned char*>(list_.data()),
                            static_cast<int>(list_.size()));
        }
        XSendEvent(display_, request.requestor, False, NoEventMask, &event);
        XFlush(display_);
    }

    Display* display_;
    std::string list_;
    Window window_ = None, target_ = None;
};

}  // namespace

int main(int count, char** arguments) {
    if (count < 4) {
        std::fputs("usage: drop_files X Y URI...\n", stderr);
        return 2;
    }
    std::string list;  // RFC 2483: one line for each, ending with CR and LF
    for (int i = 3; i < count; ++i) list += std::string(arguments[i]) + "\r\n";
    Display* display = XOpenDisplay(nullptr);
    if (!display) {
        std::fputs("no display\n", stderr);
        return 1;
    }
    Ending ending;
    {
        Source source(display, std::move(list));
        ending = source.drop(std::atoi(arguments[1]), std::atoi(arguments[2]));
    }
    XCloseDisplay(display);
    static constexpr std::array<const char*, 5> kWords = {"finished", "nothing takes files there", "",
                                                          "refused", "no answer"};
    std::puts(kWords[static_cast<size_t>(ending)]);
    return static_cast<int>(ending);
}
