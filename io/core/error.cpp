#include "io/core/error.h"

#include "io/core/terminal.h"

namespace lucarne {

std::string Error::line() const {
    constexpr size_t kMost = 1000;  // bytes of each part; the start of a file's text is enough to find it
    std::string text = shown(what, kMost);
    if (!why.empty()) text += (text.empty() ? "" : ": ") + shown(why, kMost);
    if (!todo.empty()) text += "; " + shown(todo, kMost);
    return text;
}

}  // namespace lucarne
