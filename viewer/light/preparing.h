// Light paths in advance (prepared_engine()), as the user starts and stops them in the window.
#pragma once

#include <string>

#include "viewer/light/lighting.h"

namespace lucarne::viewer {

/// Returns why nothing can be prepared here; empty: it can.
std::string why_not_prepared(const Lighting& model);
/// Returns what it takes: time, memory, disk.
std::string preparing_cost(const Lighting& model);
/// Returns what it gives.
std::string preparing_gain();
/// Whether it runs, because the user has asked for it or because the engine draws that needs it.
bool is_preparing(const Lighting& model);
/// The finished share, 0..1.
double prepared_share(const View& view);
/// Returns how far it is, and about how long it still takes.
std::string preparing_progress(const Lighting& model);
/// Returns what has been prepared, its size and file; empty: nothing.
std::string prepared_state(const Lighting& model);

/// Starts it. An engine of the moods gives way to the prepared one, which shows what is there meanwhile. Does
/// nothing if why_not_prepared().
void prepare(const Lighting& model);
/// Stops it. Pictures are by the engine that drew before.
void stop_preparing(const Lighting& model);
/// Returns what is kept of it if it is stopped.
std::string what_stopping_keeps(const Lighting& model);
/// Takes the newest share, and measures from when work began, for the time that is left.
void take_progress(const Lighting& model, BakeProgress progress);
/// Applies what the newest picture, of the open scans, says of it.
void follow_preparing(const Lighting& model);
/// Begins with other scans.
void begin_preparation(const Lighting& model, Preparation preparation);
/// The engine whose precomputation has to run whatever engine draws (FrameRequest::prepares); may be empty.
std::string_view engine_to_prepare(const Lighting& model);

void draw_preparing(const Lighting& model);      ///< part of the section Light
void draw_preparing_bar(const Lighting& model);  ///< part of the bar of moods
/// Returns the width of the button that the bar of moods has for it, pixels; 0: none.
float preparing_button_width(const Lighting& model);

}  // namespace lucarne::viewer
