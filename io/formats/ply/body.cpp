#include "io/formats/ply/body.h"

#include <algorithm>

#include "io/formats/common/body_guess.h"
#include "io/formats/common/text.h"

namespace lucarne::io::ply {
namespace {

/// Returns the bytes of all elements but the vertices; nothing if they depend on the body.
std::optional<std::array<uint64_t, 2>> bytes_around(const Header& header, uint64_t most) {
    std::array<uint64_t, 2> bytes{};  // before and after the vertices
    for (size_t e = 0; e < header.elements.size(); ++e) {
        const Element& element = header.elements[e];
        if (e == header.vertex || element.count == 0) continue;
        if (element.has_list()) return std::nullopt;
        const uint64_t each = element.record_bytes();
        uint64_t& sum = bytes[e > header.vertex];
        if (each > 0 && element.count > (most - sum) / each) return std::nullopt;
        sum += element.count * each;
    }
    return bytes;
}

}  // namespace

Result<void> fit_body(const ByteSource& file, Header& header, bool salvage) {
    Element& vertices = header.elements[header.vertex];
    const auto around = bytes_around(header, file.size());
    if (header.encoding == Encoding::ascii || vertices.has_list() || !around) return {};
    const uint64_t there = file.size() - header.data_offset;
    if ((*around)[0] + (*around)[1] > there) return {};
    std::vector<ScalarType> types;
    for (const Property& p : vertices.properties) types.push_back(p.type);
    StatedBody body{header.data_offset + (*around)[0], there - (*around)[0] - (*around)[1], vertices.count,
                    types};
    body.big_endian = header.encoding == Encoding::big_endian;
    constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
    for (size_t k = 0; k < 3; ++k) {
        const size_t found = index_of_name(vertices.properties, kAxes[k], &Property::name);
        body.axes[k] = found < types.size() ? found : body.axes[0];  // without z: x again
    }
    LUCARNE_ASSIGN(const BodyGuess guess, io::fit_body(file, body, salvage));
    for (Property& p : vertices.properties)
        if (guess.doubles && p.type == ScalarType::f32) p.type = ScalarType::f64;
    vertices.count += guess.more;
    for (size_t i = 0; i < guess.padding; ++i) vertices.properties.push_back({"", ScalarType::u8, {}});
    return {};
}

}  // namespace lucarne::io::ply
