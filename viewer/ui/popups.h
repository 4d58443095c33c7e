#pragma once

namespace lucarne::viewer {

/// Closes open menus, lists and other popups; a question (a modal window) and what is below it stay. Returns
/// whether any was open. Call at the start of a frame.
bool close_popups();

}  // namespace lucarne::viewer
