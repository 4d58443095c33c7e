#include "io/formats/ply/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"
#include "io/formats/mesh/source.h"
#include "io/formats/mesh/textures.h"
#include "io/formats/ply/layout.h"
#include "io/formats/ply/values.h"

namespace lucarne::io::ply {
namespace {

constexpr size_t kNowhere = ~size_t{0};

/// Returns the index of the first property that has one of these names.
size_t property_of(const Element& element, std::initializer_list<std::string_view> names, bool list) {
    size_t alike = kNowhere;  // first match that differs only in case
    for (const auto name : names)
        for (size_t i = 0; i < element.properties.size(); ++i) {
            const Property& p = element.properties[i];
            if (p.count.has_value() != list || !same_letters(p.name, name)) continue;
            if (p.name == name) return i;
            alike = std::min(alike, i);
        }
    return alike;
}
size_t indices_of(const Element& element) {
    return property_of(element, {"vertex_indices", "vertex_index"}, true);
}
bool is_face(const Element& element) {
    return element.name == "face" && element.count > 0 && indices_of(element) != kNowhere;
}

class MeshLoader {
 public:
    MeshLoader(const std::shared_ptr<const ByteSource>& file, const Header& header, double color_white,
               bool salvage)
        : file_(file),
          header_(header),
          input_(file, header.data_offset, file->size()),
          companions_(mesh_, file->path()),
          to_byte_(255 / color_white),
          salvage_(salvage) {}

    Result<void> load() {
        textures();
        for (size_t e = 0; e < header_.vertex; ++e)
            LUCARNE_TRY(skip_element(input_, header_, header_.elements[e]));
        LUCARNE_TRY(vertices(header_.vertices()));
        LUCARNE_TRY(faces_among(header_.vertex + 1, header_.elements.size()));
        // Faces that stand before their vertices are skipped in the first pass.
        input_ = BufferedInput(file_, header_.data_offset, file_->size());
        lost_place_ = false;
        LUCARNE_TRY(faces_among(0, header_.vertex));
        mesh_.finish();
        return {};
    }
    mesh::Mesh& mesh() { return mesh_; }
    uint64_t state() const { return companions_.state(); }
    uint64_t faces() const {
        uint64_t count = 0;
        for (const Element& element : header_.elements) count += is_face(element) ? element.count : 0;
        return count;
    }
    const Losses& vertex_losses() const { return vertex_losses_; }
    const Losses& face_losses() const { return face_losses_; }

 private:
    void textures() {
        for (const std::string& comment : header_.comments) {
            std::string_view rest = comment;
            if (next_word(rest) != "TextureFile") continue;
            mesh::Material& material = mesh_.materials.emplace_back();
            material.texture = companions_.texture(without_quotes(rest), file_->path().parent_path());
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
        wraps_ = color && color->type == ScalarType::u8;
        const size_t u = property_of(element, {"texture_u", "s", "u"}, false);
        const size_t v = property_of(element, {"texture_v", "t", "v"}, false);
        for (uint64_t i = 0; i < element.count && !lost_place_; ++i) {
            LUCARNE_ASSIGN(const bool kept,
                           next_entry(element, i, {vertex_losses_, lost::damaged, lost::cut_off}));
            if (lost_place_) break;
            // A lost vertex keeps its index; its faces are left out.
            const auto value = [&](size_t property) {
                return !kept                  ? std::numeric_limits<double>::quiet_NaN()
                       : property == kNowhere ? 0.0
                                              : entry_.values[entry_.begin[property]];
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
        // A "char" that means uchar is read as a negative number.
        const double whole = std::round((wraps_ && value < 0 ? value + 256 : value) * to_byte_);
        return static_cast<uint8_t>(whole >= 0 ? std::min(whole, 255.0) : 0.0);
    }

    /// Where losses are counted, and under which names.
    struct Tally {
        Losses& losses;
        std::string_view damaged, cut;
    };
    /// Reads entry `i` (from 0) into entry_. Returns false if it is lost. Once the place in the file is lost,
    /// nothing after it can be read.
    Result<bool> next_entry(const Element& element, uint64_t i, const Tally& tally) {
        const uint64_t begin = input_.position(), left = element.count - i;
        LUCARNE_ASSIGN(const Fate fate, fate_of(read_entry(input_, header_, element, i + 1, entry_), input_,
                                                header_, element, begin, left, salvage_));
        if (fate == Fate::lost) add_loss(tally.losses, tally.damaged, 1);
        if (fate == Fate::rest_lost) add_loss(tally.losses, tally.cut, left);
        lost_place_ = fate == Fate::rest_lost;
        return fate == Fate::kept;
    }

    Result<void> faces_among(size_t first, size_t last) {
        const auto& all = header_.elements;
        while (last > first && !is_face(all[last - 1])) --last;
        for (size_t e = first; e < last; ++e) {
            if (lost_place_) {
                if (is_face(all[e])) add_loss(face_losses_, mesh::kCutFaces, all[e].count);
            } else if (is_face(all[e])) {
                LUCARNE_TRY(faces(all[e]));
            } else if (auto done = skip_element(input_, header_, all[e]); !done) {
                lost_place_ = salvage_ && done.error().kind == ErrorKind::input_rejected;
                if (!lost_place_) return done;
            }
        }
        return {};
    }

    struct FaceColumns {
        size_t indices, texcoord, texnumber;
        std::array<size_t, 3> rgb;
        bool colored;
    };
    static FaceColumns columns_of(const Element& element) {
        FaceColumns columns{indices_of(element),
                            property_of(element, {"texcoord"}, true),
                            property_of(element, {"texnumber"}, false),
                            {property_of(element, {"red"}, false), property_of(element, {"green"}, false),
                             property_of(element, {"blue"}, false)},
                            false};
        columns.colored = std::ranges::all_of(columns.rgb, [&](size_t p) {
            return p != kNowhere && scalar_bytes(element.properties[p].type) == 1;
        });
        return columns;
    }

    Result<void> faces(const Element& element) {
        const FaceColumns columns = columns_of(element);
        for (uint64_t i = 0; i < element.count && !lost_place_; ++i) {
            LUCARNE_ASSIGN(const bool kept,
                           next_entry(element, i, {face_losses_, mesh::kDamagedFaces, mesh::kCutFaces}));
            if (!kept) continue;
            auto named = corners(columns.indices, i);
            if (named)
                add_face(columns);
            else if (salvage_)
                add_loss(face_losses_, mesh::kDamagedFaces, 1);
            else
                return named;
        }
        return {};
    }

    Result<void> corners(size_t indices, uint64_t i) {
        polygon_.clear();
        for (const double index : entry_.of(indices)) {
            if (!(index >= 0) || index >= static_cast<double>(mesh_.positions.size()))
                return rejected(input_.path(), fmt::format("face {} names vertex {}, of {}", i + 1, index,
                                                           mesh_.positions.size()));
            polygon_.push_back({static_cast<uint32_t>(index)});
        }
        return {};
    }

    void add_face(const FaceColumns& columns) {
        if (columns.texcoord != kNowhere) add_coordinates(entry_.of(columns.texcoord));
        uint32_t material = mesh_.materials.empty() ? mesh::kNone : 0;
        if (columns.texnumber != kNowhere) {
            const double texture = entry_.of(columns.texnumber)[0];
            material = texture >= 0 && texture < static_cast<double>(mesh_.materials.size())
                           ? static_cast<uint32_t>(texture)
                           : mesh::kNone;
        }
        std::optional<mesh::Color8> color;
        if (columns.colored) {
            color.emplace();
            for (size_t k = 0; k < 3; ++k)
                (*color)[k] = static_cast<uint8_t>(static_cast<int>(entry_.of(columns.rgb[k])[0]));
        }
        mesh_.add(polygon_, material, color);
    }

    /// A list has two coordinates per corner. Any other length means no coordinates, as MeshLab writes for
    /// faces without them.
    void add_coordinates(std::span<const double> list) {
        if (by_vertex_ || list.size() != 2 * polygon_.size()) return;
        for (size_t c = 0; c < polygon_.size(); ++c) {
            polygon_[c].coordinate = static_cast<uint32_t>(mesh_.coordinates.size());
            mesh_.coordinates.emplace_back(list[2 * c], list[2 * c + 1]);
        }
    }

    const std::shared_ptr<const ByteSource>& file_;
    const Header& header_;
    BufferedInput input_;
    mesh::Mesh mesh_;
    mesh::Companions companions_;
    Entry entry_;
    std::vector<mesh::Corner> polygon_;
    Losses vertex_losses_, face_losses_;
    double to_byte_;
    bool salvage_;
    bool wraps_ = false;       ///< colours are bytes
    bool by_vertex_ = false;   ///< texture coordinates belong to vertices
    bool lost_place_ = false;  ///< the beginning of the next entry is unknown
};

}  // namespace

bool has_faces(const Header& header) {
    return std::any_of(header.elements.begin(), header.elements.end(), is_face);
}

Result<Faces> open_mesh(const std::shared_ptr<const ByteSource>& file, const Header& header, ScanInfo info,
                        const ReadOptions& options) {
    MeshLoader loader(file, header, color_white(info.color_bits), options.salvage);
    LUCARNE_TRY(loader.load());
    Faces faces{nullptr, loader.face_losses()};
    if (loader.mesh().triangles.empty()) {
        if (!options.quiet) log::warn("{}: has no whole face with an area; its vertices are read", info.path);
        return faces;
    }
    add_losses(info.losses, loader.vertex_losses());
    add_losses(info.losses, faces.losses);
    info.format += ", mesh";
    info.notes = {.mesh = MeshNotes{.faces = loader.faces()}};
    LUCARNE_ASSIGN(faces.mesh,
                   mesh::sampled(std::move(loader.mesh()), std::move(info), loader.state(), options));
    return faces;
}

Result<mesh::Mesh> load_mesh(const std::shared_ptr<const ByteSource>& file, const Header& header,
                             uint32_t color_bits, bool salvage) {
    MeshLoader loader(file, header, color_white(color_bits), salvage);
    LUCARNE_TRY(loader.load());
    return std::move(loader.mesh());
}

}  // namespace lucarne::io::ply
