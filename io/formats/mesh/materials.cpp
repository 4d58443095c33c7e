#include "io/formats/mesh/materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/formats/common/text.h"

namespace lucarne::io::mesh {
namespace {

std::optional<Color8> color_of(std::string_view rest) {
    std::array<double, 3> rgb{};
    for (size_t k = 0; k < 3; ++k) {
        const auto word = next_word(rest);
        const auto value = parse_number<double>(word);
        // A single number means grey.
        if (!value && (k == 0 || !word.empty())) return std::nullopt;
        rgb[k] = value.value_or(rgb[0]);
    }
    Color8 color{};
    for (size_t k = 0; k < 3; ++k)
        color[k] =
            static_cast<uint8_t>(std::lround(std::clamp(std::isnan(rgb[k]) ? 0.0 : rgb[k], 0.0, 1.0) * 255));
    return color;
}

/// Reads the options before a picture's name. Returns the rest, which is the name and may hold blanks.
std::string_view texture_options(std::string_view rest, Material& material) {
    struct Option {
        std::string_view name;
        int least, most;  ///< number of words that follow; words beyond `least` must be numbers
    };
    static constexpr std::array<Option, 13> kOptions = {{{"-blendu", 1, 1},
                                                         {"-blendv", 1, 1},
                                                         {"-bm", 1, 1},
                                                         {"-boost", 1, 1},
                                                         {"-cc", 1, 1},
                                                         {"-clamp", 1, 1},
                                                         {"-imfchan", 1, 1},
                                                         {"-mm", 2, 2},
                                                         {"-o", 1, 3},
                                                         {"-s", 1, 3},
                                                         {"-t", 1, 3},
                                                         {"-texres", 1, 1},
                                                         {"-type", 1, 1}}};
    for (;;) {
        auto after = rest = trimmed(rest);
        const auto word = next_word(after);
        const auto option =
            std::find_if(kOptions.begin(), kOptions.end(), [&](const Option& o) { return o.name == word; });
        if (option == kOptions.end()) return rest;
        std::array<double, 3> values = {NAN, NAN, NAN};
        for (int i = 0; i < option->most; ++i) {
            auto further = after;
            const auto value = next_word(further);
            const auto number = parse_number<double>(value);
            if (i >= option->least && !number) break;
            if (number) values[static_cast<size_t>(i)] = *number;
            if (word == "-clamp") material.clamp = value == "on";
            after = further;
        }
        const auto set = [&](glm::dvec2& of) {
            if (std::isfinite(values[0])) of.x = values[0];
            if (std::isfinite(values[1])) of.y = values[1];
        };
        if (word == "-o") set(material.offset);
        if (word == "-s") set(material.scale);
        rest = after;
    }
}

}  // namespace

void read_materials(std::string_view text, const std::filesystem::path& folder, Companions& companions,
                    Mesh& mesh, std::map<std::string, uint32_t, std::less<>>& by_name) {
    Material* material = nullptr;
    while (!text.empty()) {
        const size_t end = text.find('\n');
        std::string_view rest = text.substr(0, end);
        text.remove_prefix(end == text.npos ? text.size() : end + 1);
        const auto word = next_word(rest);
        if (same_letters(word, "newmtl")) {
            const auto [at, fresh] =
                by_name.emplace(trimmed(rest), static_cast<uint32_t>(mesh.materials.size()));
            material = fresh ? &mesh.materials.emplace_back() : nullptr;
        } else if (material && same_letters(word, "Kd")) {
            material->color = color_of(rest);
        } else if (material && same_letters(word, "map_Kd")) {
            const auto name = without_quotes(texture_options(rest, *material));
            if (!name.empty()) material->texture = companions.texture(name, folder);
        }
    }
}

}  // namespace lucarne::io::mesh
