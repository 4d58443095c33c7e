// Frames of ImGui without a window.
#pragma once

#include <imgui.h>

#include "viewer/ui/font.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::test {

/// ImGui's context with a mouse and keys, which a test moves and presses.
class ImguiContext {
 public:
    explicit ImguiContext(const ImVec2& size) {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = size;
        io.DeltaTime = 1.0f / 60;
        viewer::add_interface_font(*io.Fonts, viewer::kTextPixels);
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    }
    ~ImguiContext() { ImGui::DestroyContext(); }
    ImguiContext(const ImguiContext&) = delete;
    ImguiContext& operator=(const ImguiContext&) = delete;

    /// Draws a frame with the mouse there.
    template <class Draw>
    void frame(const ImVec2& mouse, bool down, const Draw& draw) const {
        ImGui::GetIO().MousePos = mouse;
        ImGui::GetIO().MouseDown[0] = down;
        ImGui::NewFrame();
        draw();
        ImGui::Render();
    }
    /// Moves the mouse there and clicks. Takes a frame more than needed, because layouts come a frame late.
    template <class Draw>
    void click(const ImVec2& mouse, const Draw& draw) const {
        for (const bool down : {false, false, true, false, false}) frame(mouse, down, draw);
    }
};

}  // namespace lucarne::test
