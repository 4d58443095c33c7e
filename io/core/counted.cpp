#include "io/core/counted.h"

#include <array>
#include <utility>

#include <fmt/format.h>

namespace lucarne {

std::string counted(uint64_t count, std::string_view many) {
    std::string phrase(many);
    if (count != 1) return fmt::format("{} {}", count, phrase);
    size_t end = 0;  // the position of the noun's last letter
    while (end < phrase.size() && !(phrase[end] == 's' && (end + 1 == phrase.size() ||
                                                           phrase[end + 1] == ' ' || phrase[end + 1] == ',')))
        ++end;
    const bool ies = end >= 2 && phrase.compare(end - 2, 2, "ie") == 0;
    if (end < phrase.size()) phrase.replace(ies ? end - 2 : end, ies ? 3 : 1, ies ? "y" : "");
    constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kVerbs = {
        {{" that are ", " that is "},
         {" which are ", " which is "},
         {" that make ", " that makes "},
         {" before them", " before it"}}};
    for (const auto& [plural, singular] : kVerbs)
        if (const size_t at = phrase.find(plural); at != phrase.npos)
            phrase.replace(at, plural.size(), singular);
    return fmt::format("1 {}", phrase);
}

}  // namespace lucarne
