#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gi/device/gl/context_watch.h"
#include "io/core/options.h"
#include "io/image/image.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/ui/key_chord.h"
#include "viewer/window/pointer_input.h"

struct GLFWwindow;

namespace lucarne::viewer {

/// The program's window with Dear ImGui, and hidden contexts of the same driver for drawing threads. Use from
/// the main thread, except wake().
class Window {
 public:
    /// Errors: no display, no OpenGL 4.5.
    static Result<std::unique_ptr<Window>> open(ImageSize size, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// The purpose of a hidden context: the picture in the window, or pictures rendered in the background.
    enum class Hidden : size_t { view, rendering };
    /// Returns the device for a worker thread, which runs at lower priority than the window's thread. The
    /// window must outlive the device. If the processor draws the window, the device is a separate one, so
    /// that Mesa's threads belong to the worker and have its lower priority. Otherwise a hidden context
    /// (open() makes the view's) is made current, and `release` releases it there.
    WorkerDevice worker_device(Hidden which);
    /// Like worker_device(), but with a new hidden context, which replaces a released one if there was one.
    Result<WorkerDevice> renew_worker_device(Hidden which);
    /// Whether the driver has lost the window's own context. Nothing is displayed then until recover().
    bool lost() { return watch_.lost(); }
    /// Replaces the window by a new one with a new context. ImGui's state stays; pictures and small textures
    /// are lost. Errors: the driver cannot make a window or context.
    Result<void> recover();
    /// Ends wait() early. May be called by any thread.
    static void wake();

    void set_title(const std::string& title);
    bool closing() const;
    void stay();             ///< resets closing()
    ImageSize size() const;  ///< as in open(): for a screen of scale 1
    /// Sets the scale of text in addition to the screen's scale. Glyphs are drawn again for it.
    void set_text_size(double size) { text_size_ = size; }
    /// Sleeps until there is input, wake() is called or `seconds` have passed, then handles the input.
    void wait(double seconds);
    ImageSize framebuffer() const;  ///< size in pixels; at least 1x1
    /// Returns the keys pressed since the last call, including keys released before the next frame.
    std::vector<KeyChord> take_pressed_keys() { return std::exchange(pressed_, {}); }

    /// Returns the files dropped on the window since the last call.
    std::vector<std::string> take_dropped_files() { return std::exchange(dropped_, {}); }

    /// Makes a texture of a small picture for panels. It lives until free_texture(), recover() or the
    /// window's end.
    unsigned make_texture(const io::Image8& image);
    void free_texture(unsigned texture);

    /// Begins a frame. ImGui and show() may be used from here until draw().
    void begin_frame();
    /// Fills the window with a picture, scaled with its aspect ratio kept. Uploads the picture if its number
    /// is new.
    void show(const Picture& picture);
    /// Draws the frame. Returns false and draws nothing if the window already shows exactly this, unless
    /// `even_if_seen`. Frames are more frequent than pictures, and without a GPU, filling the window takes
    /// processor time from pictures.
    bool draw(bool even_if_seen);
    /// Returns what draw() has drawn: RGBA8 of framebuffer()'s size, row 0 on top. Call between draw() and
    /// swap().
    std::vector<std::byte> capture() const;
    void swap();
    /// Hides the window at once, although the current picture may have to be finished before the program
    /// ends.
    void hide();

 private:
    /// A rectangle in pixels of the framebuffer, y downward.
    struct PictureRect {
        int left = 0, top = 0, right = 0, bottom = 0;
        bool empty() const { return right <= left || bottom <= top; }
    };

    /// A fingerprint of what the window shows.
    struct Seen {
        uint64_t panels = 0, picture = 0;
        uint32_t width = 0, height = 0;
        bool operator==(const Seen&) const = default;
    };

    Window() = default;
    Result<std::unique_ptr<gi::Device>> own_device(Hidden which, bool software);
    void draw_picture(ImageSize size);
    double screen_scale() const;  ///< 1: about 96 dots an inch
    void fit_text();
    void take_pointer();
    PointerInput::Time event_time() const;
    Result<void> create(ImageSize size, const std::string& title);
    Result<void> create_window(ImageSize size, const std::string& title);
    Result<void> create_hidden(Hidden which);
    void take_context();

    GLFWwindow* window_ = nullptr;
    std::array<GLFWwindow*, 2> hidden_{};
    std::string title_;
    bool initialised_ = false, imgui_ = false;
    double text_size_ = 1;                     ///< requested scale of text
    double text_scale_ = 0, text_pixels_ = 0;  ///< scale of the glyphs; pixels of a desktop unit then
    unsigned texture_ = 0, framebuffer_ = 0;   ///< the picture; what it is copied from
    std::vector<unsigned> small_;              ///< textures for panels
    ImageSize texture_size_;
    uint64_t shown_ = 0;        ///< the number of the picture in the texture
    PictureRect place_;         ///< the picture's place in this frame; empty: no picture
    std::optional<Seen> seen_;  ///< nothing: not known
    bool software_ = false;     ///< the window is drawn by the processor
    PointerInput pointer_;
    double wait_began_ = 0, wait_ended_ = 0;  ///< s on GLFW's clock
    std::vector<KeyChord> pressed_;
    std::vector<std::string> dropped_;
    gi::ContextWatch watch_;
    gi::LossPlan window_losses_ = gi::LossPlan::from_environment("LUCARNE_TEST_LOSE_WINDOW");
    gi::LossPlan worker_losses_ = gi::LossPlan::from_environment("LUCARNE_TEST_LOSE_CONTEXT");
};

}  // namespace lucarne::viewer
