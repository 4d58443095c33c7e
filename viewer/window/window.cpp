#include "viewer/window/window.h"

#include "viewer/ui/on_screen.h"

// Include epoxy before GLFW, which otherwise includes the system's GL header.
#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <algorithm>
#include <cfloat>
#include <cmath>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include "io/core/process.h"
#include "viewer/ui/font.h"
#include "viewer/window/drawn_frame.h"

namespace lucarne::viewer {
namespace {

constexpr float kDoubleClickReach = 6;  ///< largest distance of two clicks, on a screen of scale 1
constexpr size_t kMostPressed = 64;     ///< keys kept between two frames
constexpr size_t kMostDropped = 1000;   ///< files
constexpr const char* kTodo =
    "start it on a desktop with OpenGL 4.5, or use lucarne render, which needs no display";

/// Returns GLFW's last error message.
std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "GLFW gives no reason";
}

}  // namespace

Result<std::unique_ptr<Window>> Window::open(ImageSize size, const std::string& title) {
    std::unique_ptr<Window> window(new Window);
    LUCARNE_TRY(window->create(size, title));
    return window;
}

Result<void> Window::create(ImageSize size, const std::string& title) {
    if (!glfwInit()) return failed("window", glfw_reason(), kTodo);
    initialised_ = true;
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    LUCARNE_TRY(create_window(size, title));
    LUCARNE_TRY(create_hidden(Hidden::view));
    glfwMakeContextCurrent(window_);
    ImGui::CreateContext();
    imgui_ = true;
    ImGui::GetIO().IniFilename = nullptr;  // ImGui writes no files to the working folder
    take_context();
    return {};
}

Result<void> Window::create_window(ImageSize size, const std::string& title) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    // Requests that the driver reports resets; drivers without support ignore it.
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
    glfwWindowHint(GLFW_VISIBLE, GLFW_TRUE);
    window_ = glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), title.c_str(),
                               nullptr, nullptr);
    if (!window_) return failed("window", glfw_reason(), kTodo);
    return {};
}

Result<void> Window::create_hidden(Hidden which) {
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    GLFWwindow* window = glfwCreateWindow(1, 1, "lucarne worker", nullptr, nullptr);
    if (!window) return failed("window", "a further context: " + glfw_reason(), kTodo);
    hidden_[static_cast<size_t>(which)] = window;
    return {};
}

/// Sets the window's callbacks and makes the objects of its context, which is current.
void Window::take_context() {
    glfwSwapInterval(1);
    watch_ = {};
    if (const auto checks = window_losses_.next()) watch_.lose_after(*checks);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
        auto& pressed = static_cast<Window*>(glfwGetWindowUserPointer(window))->pressed_;
        if (action == GLFW_PRESS && pressed.size() < kMostPressed)
            pressed.push_back({key, modifiers & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT)});
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->pointer_.move(x, y);
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
        auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
        self.pointer_.set_button(static_cast<size_t>(button), action == GLFW_PRESS, self.event_time());
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        auto& dropped = static_cast<Window*>(glfwGetWindowUserPointer(window))->dropped_;
        for (int i = 0; i < count && dropped.size() < kMostDropped; ++i) dropped.emplace_back(paths[i]);
    });
    double x = 0, y = 0;
    glfwGetCursorPos(window_, &x, &y);
    pointer_.move(x, y);
    ImGui_ImplGlfw_InitForOpenGL(window_, true);  // its callbacks call ours
    ImGui_ImplOpenGL3_Init("#version 450 core");
    glGenTextures(1, &texture_);
    glGenFramebuffers(1, &framebuffer_);
    const auto device = gi::Device::current();
    software_ = device && (*device)->info().software;
    // The window was uncovered, or resized to its old size.
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->seen_.reset();
    });
}

Result<void> Window::recover() {
    int x = 0, y = 0;
    glfwGetWindowPos(window_, &x, &y);
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    const bool closing_already = closing();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    glfwDestroyWindow(window_);
    window_ = nullptr;
    imgui_ = false;
    small_.clear();
    texture_size_ = {};
    shown_ = 0;
    seen_.reset();
    std::ranges::fill(ImGui::GetIO().KeysDown, false);  // the old window received the releases
    pointer_.clear();
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_FALSE);  // the size is scaled for the screen already
    LUCARNE_TRY(create_window(
        {static_cast<uint32_t>(std::max(width, 1)), static_cast<uint32_t>(std::max(height, 1))}, title_));
    glfwSetWindowPos(window_, x, y);
    glfwSetWindowShouldClose(window_, closing_already);
    glfwMakeContextCurrent(window_);
    imgui_ = true;
    take_context();
    return {};
}

Window::~Window() {
    if (imgui_) {
        glDeleteTextures(1, &texture_);
        glDeleteFramebuffers(1, &framebuffer_);
        glDeleteTextures(static_cast<GLsizei>(small_.size()), small_.data());
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    for (GLFWwindow* hidden : hidden_)
        if (hidden) glfwDestroyWindow(hidden);
    if (window_) glfwDestroyWindow(window_);
    if (initialised_) glfwTerminate();
}

Result<std::unique_ptr<gi::Device>> Window::own_device(Hidden which, bool software) {
    if (software)
        if (auto device = gi::Device::headless()) return device;
    glfwMakeContextCurrent(hidden_[static_cast<size_t>(which)]);
    return gi::Device::current();
}

WorkerDevice Window::worker_device(Hidden which) {
    return {[this, which, software = software_] {
                give_way();
                auto device = own_device(which, software);
                if (which != Hidden::view) return device;
                if (const auto checks = worker_losses_.next(); checks && device)
                    (*device)->lose_after(*checks);
                return device;
            },
            [] { glfwMakeContextCurrent(nullptr); }};
}

Result<WorkerDevice> Window::renew_worker_device(Hidden which) {
    GLFWwindow*& before = hidden_[static_cast<size_t>(which)];
    if (before) glfwDestroyWindow(std::exchange(before, nullptr));
    LUCARNE_TRY(create_hidden(which));
    return worker_device(which);
}

void Window::wake() {
    glfwPostEmptyEvent();
}

void Window::hide() {
    glfwHideWindow(window_);
    glfwPollEvents();
}

void Window::set_title(const std::string& title) {
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
}

bool Window::closing() const {
    return glfwWindowShouldClose(window_);
}

void Window::wait(double seconds) {
    wait_began_ = glfwGetTime();
    if (pointer_.pending())
        glfwPollEvents();
    else
        glfwWaitEventsTimeout(std::max(seconds, 1e-4));
    wait_ended_ = glfwGetTime();
}

/// Returns when an event happened that GLFW passes on now. GLFW does not tell the time of events. One that
/// was there when wait() began came at any time since the last wait ended.
PointerInput::Time Window::event_time() const {
    constexpr double kAtOnce = 2e-3;  // s
    const double now = glfwGetTime();
    return {now - wait_began_ < kAtOnce ? wait_ended_ : now, now};
}

ImageSize Window::framebuffer() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<uint32_t>(std::max(width, 1)), static_cast<uint32_t>(std::max(height, 1))};
}

void Window::stay() {
    glfwSetWindowShouldClose(window_, GLFW_FALSE);
}

double Window::screen_scale() const {
    float scale = 1;
    glfwGetWindowContentScale(window_, &scale, nullptr);
    return scale > 0 ? scale : 1;
}

ImageSize Window::size() const {
    const ImageSize pixels = framebuffer();
    const auto side = [&](uint32_t length) {
        return static_cast<uint32_t>(std::max(std::lround(length / screen_scale()), 1l));
    };
    return {side(pixels.width), side(pixels.height)};
}

/// Draws the glyphs again at their display size, because stretched glyphs would be blurred.
void Window::fit_text() {
    const double scale = std::clamp(screen_scale() * text_size_, 0.5, 8.0);
    // X11 counts in pixels. Wayland counts in units of several pixels, and so does ImGui then.
    int units = 0;
    glfwGetWindowSize(window_, &units, nullptr);
    const double pixels = framebuffer().width / static_cast<double>(std::max(units, 1));
    if (std::abs(scale - text_scale_) < 1e-3 && std::abs(pixels - text_pixels_) < 1e-3) return;
    text_scale_ = scale;
    text_pixels_ = pixels;
    ImGui::GetStyle() = ImGuiStyle();
    ImGui::StyleColorsDark();
    ImGui::GetStyle().ScaleAllSizes(static_cast<float>(scale / pixels));
    ImGuiIO& io = ImGui::GetIO();
    io.FontGlobalScale = static_cast<float>(1 / pixels);
    io.MouseDoubleClickMaxDist = kDoubleClickReach * static_cast<float>(scale / pixels);
    io.Fonts->Clear();
    add_interface_font(*io.Fonts, std::round(kTextPixels * static_cast<float>(scale)));
    ImGui_ImplOpenGL3_DestroyFontsTexture();  // the next frame makes another
    ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::begin_frame() {
    place_ = {};
    ImGui_ImplOpenGL3_NewFrame();  // makes the objects that the first glyphs need
    fit_text();
    ImGui_ImplGlfw_NewFrame();
    take_pointer();
    ImGui::NewFrame();
}

/// Replaces the mouse that ImGui's backend has sampled by the next event.
void Window::take_pointer() {
    ImGuiIO& io = ImGui::GetIO();
    const bool outside = io.MousePos.x == -FLT_MAX && !pointer_.pending();
    const PointerInput::State& mouse = pointer_.next();
    if (!outside) io.MousePos = {static_cast<float>(mouse.x), static_cast<float>(mouse.y)};
    std::ranges::copy(mouse.down, io.MouseDown);
    // Frames may be longer than a double-click, so its time is judged by the events.
    io.MouseDoubleClickTime = mouse.soon ? FLT_MAX : 0.0f;
}

unsigned Window::make_texture(const io::Image8& image) {
    unsigned texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, static_cast<int>(image.width), static_cast<int>(image.height), 0,
                 GL_RGB, GL_UNSIGNED_BYTE, image.bytes.data());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    small_.push_back(texture);
    return texture;
}

void Window::free_texture(unsigned texture) {
    if (std::erase(small_, texture)) glDeleteTextures(1, &texture);
}

/// Copies the picture to the window, which is a third less work for a processor than ImGui's blending.
void Window::draw_picture(ImageSize size) {
    const auto width = static_cast<int>(texture_size_.width), height = static_cast<int>(texture_size_.height);
    const auto below = static_cast<int>(size.height);
    const bool as_large = place_.right - place_.left == width && place_.bottom - place_.top == height;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    glDisable(GL_SCISSOR_TEST);
    // The texture's row 0 is the picture's top, the window's is its bottom.
    glBlitFramebuffer(0, 0, width, height, place_.left, below - place_.top, place_.right,
                      below - place_.bottom, GL_COLOR_BUFFER_BIT, as_large ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

bool Window::draw(bool even_if_seen) {
    ImGui::Render();
    const ImageSize size = framebuffer();
    const Seen now{fingerprint(*ImGui::GetDrawData()), place_.empty() ? 0 : shown_, size.width, size.height};
    if (now == seen_ && !even_if_seen) return false;
    seen_ = now;
    glViewport(0, 0, static_cast<int>(size.width), static_cast<int>(size.height));
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (!place_.empty()) draw_picture(size);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    return true;
}

void Window::swap() {
    glfwSwapBuffers(window_);
}

void Window::show(const Picture& picture) {
    const int width = static_cast<int>(picture.size.width), height = static_cast<int>(picture.size.height);
    glBindTexture(GL_TEXTURE_2D, texture_);
    if (picture.number != shown_) {
        if (picture.size.width != texture_size_.width || picture.size.height != texture_size_.height) {
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
            texture_size_ = picture.size;
        }
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
                        picture.rgba.data());
        shown_ = picture.number;
    }
    // A picture made before the window changed its shape keeps its own shape until the next picture.
    const ImageSize size = framebuffer();
    const double scale =
        std::max(static_cast<double>(size.width) / width, static_cast<double>(size.height) / height);
    const auto half = [&](int length) { return length * scale / 2; };
    const double x = size.width / 2.0, y = size.height / 2.0;
    place_ = {static_cast<int>(std::lround(x - half(width))), static_cast<int>(std::lround(y - half(height))),
              static_cast<int>(std::lround(x + half(width))),
              static_cast<int>(std::lround(y + half(height)))};
}

std::vector<std::byte> Window::capture() const {
    const ImageSize size = framebuffer();
    const size_t row = size_t{size.width} * 4;
    std::vector<std::byte> pixels(row * size.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, static_cast<int>(size.width), static_cast<int>(size.height), GL_RGBA, GL_UNSIGNED_BYTE,
                 pixels.data());
    for (uint32_t y = 0; y < size.height / 2; ++y)  // OpenGL's row 0 is at the bottom
        std::swap_ranges(pixels.begin() + static_cast<ptrdiff_t>(y * row),
                         pixels.begin() + static_cast<ptrdiff_t>((y + 1) * row),
                         pixels.begin() + static_cast<ptrdiff_t>((size.height - 1 - y) * row));
    return pixels;
}

}  // namespace lucarne::viewer
