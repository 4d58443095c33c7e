// What is derived from the LAS header in the notes of a scan: see header.h.
#include <fmt/format.h>

#include "io/formats/common/format.h"
#include "io/formats/las/header.h"

namespace lucarne::io::las {

Result<Header> header_of(const std::string& file, const FormatNotes& notes) {
    if (!notes.las_damage.empty())
        return rejected(file,
                        fmt::format("the LAS header kept with the points is damaged ({})", notes.las_damage));
    Header header{*notes.las};
    header.scale = glm::dvec3(1.0);  // the writer chooses them
    header.offset = glm::dvec3(0.0);
    return header;
}

std::optional<Lattice> lattice_of(const ScanInfo& scan) {
    const auto& las = scan.notes.las;
    if (!las) return std::nullopt;
    for (int axis = 0; axis < 3; ++axis)
        if (las->scale[axis] == 0 || !usable(las->scale[axis]) || !usable(las->offset[axis]))
            return std::nullopt;
    return Lattice{las->scale, las->offset};
}

}  // namespace lucarne::io::las
