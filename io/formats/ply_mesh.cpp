#include "io/formats/ply_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/log.h"
#include "io/formats/format.h"
#include "io/formats/mesh/source.h"
#include "io/formats/mesh/textures.h"
#include "io/formats/ply_layout.h"
#include "io/formats/ply_values.h"
#include "io/formats/text.h"

namespace lucarne::io::ply {
namespace {

constexpr size_t kNowhere = ~size_t{0};

/// The index of a property, of these names the first that is there.
size_t property_of(const Element& element, std::initializer_list<std::string_view> names, bool list) {
    for (const auto name : names)
        for (size_t i = 0; i < element.properties.size(); ++i)
            if (element.properties[i].name == name && element.properties[i].count.has_value() == list)
                return i;
    return kNowhere;
}
size_t indices_of(const Element& element) {
    return property_of(element, {"vertex_indices", "vertex_index"}, true);
}
bool is_face(const Element& element) {
    return element.name == "face" && element.count > 0 && indices_of(element) != kNowhere;
}

class MeshLoader {
 public:
    MeshLoader(const std::shared_ptr<const InputFile>& file, const Header& header, double color_white)
        : file_(file),
          header_(header),
          input_(file, header.data_offset, file->size()),
          companions_(mesh_, file->path()),
          to_byte_(255 / color_white) {}

    Result<void> load() {
        textures();
        for (size_t e = 0; e < header_.elements.size(); ++e) {
            const Element& element = header_.elements[e];
            if (e == header_.vertex)
                LUCARNE_TRY(vertices(element));
            else if (is_face(element))
                LUCARNE_TRY(faces(element, e));
            else
                LUCARNE_TRY(skip_element(input_, header_, element));
        }
        mesh_.finish();
        return {};
    }
    mesh::Mesh& mesh() { return mesh_; }
    uint64_t state() const { return companions_.state(); }

 private:
    void textures() {
        for (const std::string& comment : header_.comments) {
            std::string_view rest = comment;
            if (next_word(rest) != "TextureFile") continue;
            while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
            mesh::Material& material = mesh_.materials.emplace_back();
            material.texture = companions_.texture(rest, file_->path().parent_path());
        }
    }

    Result<void> vertices(const Element& element) {
        const Layout layout = make_layout(element.properties, header_.encoding);
        const Attribute* color = layout.schema.find(names::color);
        const bool has_normals = layout.schema.find(names::normal) != nullptr;
        std::array<size_t, 3> xyz{}, rgb{}, normal{};
        for (size_t k = 0; k < 3; ++k) {
            constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
            xyz[k] = property_of(element, {kAxes[k]}, false);
            for (const auto& column : layout.columns) {
                if (column.component != k) continue;
                if (column.attribute == names::color)
                    rgb[k] = property_of(element, {column.property.name}, false);
                if (column.attribute == names::normal)
                    normal[k] = property_of(element, {column.property.name}, false);
            }
        }
        const size_t u = property_of(element, {"texture_u", "s", "u"}, false);
        const size_t v = property_of(element, {"texture_v", "t", "v"}, false);
        Entry entry;
        for (uint64_t i = 0; i < element.count; ++i) {
            LUCARNE_TRY(read_entry(input_, header_, element, i + 1, entry));
            const auto value = [&](size_t property) {
                return property == kNowhere ? 0.0 : entry.values[entry.begin[property]];
            };
            mesh_.positions.emplace_back(value(xyz[0]), value(xyz[1]), value(xyz[2]));
            if (color)
                mesh_.colors.push_back({byte(value(rgb[0])), byte(value(rgb[1])), byte(value(rgb[2]))});
            if (has_normals) mesh_.normals.emplace_back(value(normal[0]), value(normal[1]), value(normal[2]));
            if (u != kNowhere && v != kNowhere) mesh_.coordinates.emplace_back(value(u), value(v));
        }
        by_vertex_ = !mesh_.coordinates.empty();
        return {};
    }

    uint8_t byte(double value) const {
        // A "char" that means uchar comes as a negative number.
        const double whole = std::round((value < 0 ? value + 256 : value) * to_byte_);
        return static_cast<uint8_t>(whole >= 0 ? std::min(whole, 255.0) : 0.0);
    }

    Result<void> faces(const Element& element, size_t which) {
        if (which < header_.vertex) return rejected(input_.path(), "has faces before its vertices");
        const size_t indices = indices_of(element), texcoord = property_of(element, {"texcoord"}, true);
        const size_t number = property_of(element, {"texnumber"}, false);
        const std::array<size_t, 3> rgb = {property_of(element, {"red"}, false),
                                           property_of(element, {"green"}, false),
                                           property_of(element, {"blue"}, false)};
        const bool colored = std::all_of(rgb.begin(), rgb.end(), [&](size_t p) {
            return p != kNowhere && scalar_bytes(element.properties[p].type) == 1;
        });
        Entry entry;
        std::vector<mesh::Corner> polygon;
        for (uint64_t i = 0; i < element.count; ++i) {
            LUCARNE_TRY(read_entry(input_, header_, element, i + 1, entry));
            polygon.clear();
            for (const double index : entry.of(indices)) {
                if (!(index >= 0) || index >= static_cast<double>(mesh_.positions.size()))
                    return rejected(input_.path(), fmt::format("face {} names vertex {}, of {}", i + 1, index,
                                                               mesh_.positions.size()));
                polygon.push_back({static_cast<uint32_t>(index)});
            }
            add_coordinates(texcoord == kNowhere ? std::span<const double>() : entry.of(texcoord), polygon);
            uint32_t material = mesh_.materials.empty() ? mesh::kNone : 0;
            if (number != kNowhere) {
                const double texture = entry.of(number)[0];
                material = texture >= 0 && texture < static_cast<double>(mesh_.materials.size())
                               ? static_cast<uint32_t>(texture)
                               : mesh::kNone;
            }
            std::optional<mesh::Color8> color;
            if (colored) {
                color.emplace();
                for (size_t k = 0; k < 3; ++k)
                    (*color)[k] = static_cast<uint8_t>(static_cast<int>(entry.of(rgb[k])[0]));
            }
            mesh_.add(polygon, material, color);
        }
        return {};
    }

    /// Two a corner; a list of any other length is none, as MeshLab writes for faces without.
    void add_coordinates(std::span<const double> list, std::vector<mesh::Corner>& polygon) {
        if (by_vertex_ || list.size() != 2 * polygon.size()) return;
        for (size_t c = 0; c < polygon.size(); ++c) {
            polygon[c].coordinate = static_cast<uint32_t>(mesh_.coordinates.size());
            mesh_.coordinates.emplace_back(list[2 * c], list[2 * c + 1]);
        }
    }

    const std::shared_ptr<const InputFile>& file_;
    const Header& header_;
    BufferedInput input_;
    mesh::Mesh mesh_;
    mesh::Companions companions_;
    double to_byte_;
    bool by_vertex_ = false;  ///< texture coordinates
};

}  // namespace

bool has_faces(const Header& header) {
    return std::any_of(header.elements.begin(), header.elements.end(), is_face);
}

Result<std::unique_ptr<PointSource>> open_mesh(const std::shared_ptr<const InputFile>& file,
                                               const Header& header, std::unique_ptr<PointSource> vertices,
                                               const ReadOptions& options) {
    ScanInfo info = vertices->info();
    MeshLoader loader(file, header, color_white(info.color_bits));
    LUCARNE_TRY(loader.load());
    if (loader.mesh().triangles.empty()) {
        log::warn("{}: none of its faces has an area; its vertices are read", info.path);
        return vertices;
    }
    info.format += ", mesh";
    return mesh::sampled(std::move(loader.mesh()), std::move(info), nlohmann::json::object(), loader.state(),
                         options);
}

}  // namespace lucarne::io::ply
