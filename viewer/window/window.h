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
#include "viewer/window/key_chord.h"
#include "viewer/window/pointer_input.h"

struct GLFWwindow;

namespace lucarne::viewer {

inline constexpr float kTextPixels = 13;  ///< on a screen of scale 1, as the font was drawn for

/// The program's window with Dear ImGui in it, and hidden contexts of the same driver for threads
/// that draw. Main thread only, but for wake().
class Window {
 public:
    /// Errors: no display, no OpenGL 4.5.
    static Result<std::unique_ptr<Window>> open(ImageSize size, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// What a device is for: the picture in the window, or those rendered beside it.
    enum class Hidden : size_t { view, rendering };
    /// Of the calling thread, which gives way to the window's; the window outlives the device. Where the
    /// window is drawn by the processor it is a device of its own: Mesa's threads then belong to the one who
    /// uses it, and give way as well. Else a hidden context (open() makes the view's) is made current, and
    /// `release` lets go of it there.
    WorkerDevice worker_device(Hidden which);
    /// The same with a new hidden context, in place of one that was released, if there was.
    Result<WorkerDevice> renew_worker_device(Hidden which);
    /// Whether the driver has lost the window's own context: nothing that is drawn is seen until recover().
    bool lost() { return watch_.lost(); }
    /// A new window in the place of the old one, with a new context; ImGui's state stays, pictures and small
    /// textures are gone. Errors: the driver makes none.
    Result<void> recover();
    /// Ends wait() early; any thread.
    static void wake();

    void set_title(const std::string& title);
    bool closing() const;
    void stay();             ///< closing() is taken back
    ImageSize size() const;  ///< as open() takes it: of a screen of scale 1
    /// How large text is, beside the scale of the screen that the window is on; glyphs are drawn anew for it.
    void set_text_size(double size) { text_size_ = size; }
    /// Sleeps until there is input, wake() or `seconds` have passed, and takes the input in.
    void wait(double seconds);
    ImageSize framebuffer() const;  ///< pixels; 1x1 at least
    /// Keys pressed since the last call, also those released again before a frame saw them.
    std::vector<KeyChord> take_pressed_keys() { return std::exchange(pressed_, {}); }

    /// Files dropped on the window since the last call.
    std::vector<std::string> take_dropped_files() { return std::exchange(dropped_, {}); }

    /// A small picture for panels; gone with the window, or before.
    unsigned make_texture(const io::Image8& image);
    void free_texture(unsigned texture);

    /// From here ImGui and show() may be used, until draw().
    void begin_frame();
    /// Fills the window with a picture, scaled without changing its shape. Uploads it when its number is new.
    void show(const Picture& picture);
    /// False where the window shows just that already, and nothing was drawn: motion and input draw more
    /// often than pictures come, and without a GPU filling the window takes the processor from those.
    bool draw(bool even_if_seen);
    /// What draw() has drawn, RGBA8 of framebuffer()'s size, row 0 on top. Between draw() and swap().
    std::vector<std::byte> capture() const;
    void swap();
    /// Off the screen at once, though a picture may still have to be finished before the program ends.
    void hide();

 private:
    /// Pixels of the framebuffer, y downward.
    struct PictureRect {
        int left = 0, top = 0, right = 0, bottom = 0;
        bool empty() const { return right <= left || bottom <= top; }
    };

    /// What the window shows.
    struct Seen {
        uint64_t panels = 0, picture = 0;
        uint32_t width = 0, height = 0;
        bool operator==(const Seen&) const = default;
    };

    Window() = default;
    Result<std::unique_ptr<gi::Device>> own_device(Hidden which, bool software);
    void draw_picture(ImageSize size);
    double screen_scale() const;  ///< 1: of about 96 dots an inch
    void fit_text();
    void take_pointer();
    Result<void> create(ImageSize size, const std::string& title);
    Result<void> create_window(ImageSize size, const std::string& title);
    Result<void> create_hidden(Hidden which);
    void take_context();

    GLFWwindow* window_ = nullptr;
    std::array<GLFWwindow*, 2> hidden_{};
    std::string title_;
    bool initialised_ = false, imgui_ = false;
    double text_size_ = 1;  ///< wanted
    double text_scale_ = 0,
           text_pixels_ = 0;  ///< what the glyphs are of, and the pixels of a unit of the desktop's then
    unsigned texture_ = 0, framebuffer_ = 0;  ///< the picture, and what it is copied from
    std::vector<unsigned> small_;             ///< textures
    ImageSize texture_size_;
    uint64_t shown_ = 0;        ///< the number of the picture in the texture
    PictureRect place_;         ///< of it, in this frame; empty: there is none
    std::optional<Seen> seen_;  ///< none: not known
    bool software_ = false;     ///< the window is drawn by the processor
    PointerInput pointer_;
    std::vector<KeyChord> pressed_;
    std::vector<std::string> dropped_;
    gi::ContextWatch watch_;
    gi::LossPlan window_losses_ = gi::LossPlan::from_environment("LUCARNE_TEST_LOSE_WINDOW");
    gi::LossPlan worker_losses_ = gi::LossPlan::from_environment("LUCARNE_TEST_LOSE_CONTEXT");
};

}  // namespace lucarne::viewer
