#include "io/core/error.h"

namespace lucarne {

std::string Error::line() const {
    std::string text = what;
    if (!why.empty()) text += (text.empty() ? "" : ": ") + why;
    if (!todo.empty()) text += "; " + todo;
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';  // one line, whatever a file is called
    return text;
}

}  // namespace lucarne
