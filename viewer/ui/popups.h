#pragma once

namespace lucarne::viewer {

/// Closes open menus, lists and other popups; a question (a modal window) and what is below it stay. Returns
/// whether any was open. Call at the start of a frame.
bool close_popups();

/// Begins a question in the middle of the window, over all else, while it is shown. Returns whether it is;
/// then ImGui::EndPopup() ends it, after ImGui::CloseCurrentPopup() if it has been answered.
bool begin_question(const char* title, bool shown);

}  // namespace lucarne::viewer
