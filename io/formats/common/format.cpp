#include "io/formats/common/format.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "io/core/terminal.h"
#include "io/formats/common/number.h"
#include "io/formats/common/text.h"

namespace lucarne::io {

std::string_view first_statement(std::string_view head) {
    const bool cut = head.size() >= kHeadBytes;
    head = without_mark(head);
    while (!head.empty()) {
        const size_t end = head.find('\n');
        if (end == head.npos && cut) break;
        const auto line = head.substr(0, end);
        head.remove_prefix(end == head.npos ? head.size() : end + 1);
        auto rest = line;
        const auto word = next_word(rest);
        if (!word.empty() && word[0] != '#') return line;
    }
    return {};
}

void set_unit(ScanInfo& info, const ReadOptions& options, std::optional<double> stated) {
    const auto unit = options.metres_per_unit ? options.metres_per_unit : stated;
    info.metres_per_unit = unit.value_or(1.0);
    info.unit_stated = unit.has_value();
}

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

std::string printable(std::string_view name) {
    constexpr size_t kMost = 64;
    std::string clean;
    while (!name.empty() && clean.size() < kMost) {
        const size_t bytes = shown_bytes(name);
        if (clean.size() + bytes > kMost) break;
        clean += bytes ? name.substr(0, bytes) : "?";
        name.remove_prefix(std::max<size_t>(bytes, 1));
    }
    return clean.empty() ? "unnamed" : clean;
}

std::string unique_name(const Schema& schema, std::string_view name) {
    const std::string clean = printable(name);
    // One pass over the schema, because thousands of attributes may share their first 64 characters.
    std::vector<bool> taken(schema.attributes.size() + 3);  // by appended number; 1 is the plain name
    for (const Attribute& a : schema.attributes) {
        if (!a.name.starts_with(clean)) continue;
        const auto rest = std::string_view(a.name).substr(clean.size());
        const bool numbered = rest.size() > 1 && rest[0] == '_' && rest[1] >= '1' && rest[1] <= '9';
        const auto number = numbered ? parse_number<size_t>(rest.substr(1)) : std::nullopt;
        if (rest.empty())
            taken[1] = true;
        else if (number && *number < taken.size())
            taken[*number] = true;
    }
    if (!taken[1]) return clean;
    const auto free = std::find(taken.begin() + 2, taken.end(), false);
    return fmt::format("{}_{}", clean, free - taken.begin());
}

}  // namespace lucarne::io
