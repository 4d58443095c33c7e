// OBJ: polygons with texture coordinates, normals and materials. Vertices alone are a point cloud. Source:
// Wavefront, "Object Files (.obj)", 1992 (Bourke's copy); colours after the coordinates, as MeshLab and
// others write them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/buffered_input.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"
#include "io/formats/mesh/materials.h"
#include "io/formats/mesh/source.h"

namespace lucarne::io {
namespace {

using namespace mesh;

constexpr std::array<std::string_view, 6> kNumbered = {"v", "vn", "vt", "vp", "f", "l"};  ///< take numbers
constexpr std::array<std::string_view, 5> kNamed = {"o", "g", "s", "mtllib", "usemtl"};

bool is_one_of(std::span<const std::string_view> words, std::string_view word) {
    return std::ranges::find(words, word) != words.end();
}

class ObjParser {
 public:
    ObjParser(const std::shared_ptr<const ByteSource>& file, bool salvage)
        : name_(file->path().string()),
          salvage_(salvage),
          input_(file, 0, file->size()),
          companions_(mesh_, file->path()) {}

    Result<void> parse() {
        LUCARNE_TRY(input_.skip_mark());
        std::string joined;  // a line that continues after a backslash
        for (;;) {
            LUCARNE_ASSIGN(const auto got, input_.line('\n'));
            if (!got) break;
            ++line_;
            std::string_view line = *got;
            while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
            const bool goes_on = line.ends_with('\\');
            if (goes_on) line.remove_suffix(1);
            if (goes_on || !joined.empty()) {
                if (joined.size() + line.size() > BufferedInput::kLargestPeek)
                    return wrong("goes on for more than 1 MiB");
                joined.append(line).append(" ");
                if (goes_on) continue;
                line = joined;
            }
            LUCARNE_TRY(take(line));
            joined.clear();
        }
        if (!joined.empty()) LUCARNE_TRY(take(joined));
        if (strange_ && mesh_.positions.empty()) return rejected(name_, "is no OBJ: it has no vertices");
        finish_colors();
        return finish_faces();
    }

    Mesh& mesh() { return mesh_; }
    uint64_t state() const { return companions_.state(); }
    uint64_t other() const { return other_; }
    uint64_t faces() const { return faces_; }
    const Losses& losses() const { return losses_; }
    /// Texture coordinates and normals that corners of triangles name but that do not exist.
    uint64_t missing() const { return missing_; }

 private:
    tl::unexpected<Error> wrong(std::string why) const {
        return rejected(name_, fmt::format("line {} {}", line_, why));
    }

    /// Reads one statement. If it is malformed and the file ends with it, the file is cut off.
    Result<void> take(std::string_view line) {
        auto done = statement(line);
        if (done || done.error().kind != ErrorKind::input_rejected) return done;
        const bool cut = input_.open_line();
        if (!salvage_)
            return cut ? rejected(name_, fmt::format("ends early: {}, and no line end", done.error().why))
                       : done;
        add_loss(losses_, cut ? kCutLine : kDamagedLines, 1);
        if (!cut) stand_in(next_word(line));
        return {};
    }

    /// Adds a placeholder for a lost entry, so that later entries keep their indices.
    void stand_in(std::string_view word) {
        if (word == "v") mesh_.positions.emplace_back(std::numeric_limits<double>::quiet_NaN());
        if (word == "vn") mesh_.normals.emplace_back(0.0f);
        if (word == "vt") mesh_.coordinates.emplace_back(0.0f);
    }

    Result<void> statement(std::string_view rest) {
        const auto word = next_word(rest);
        if (word.empty() || word[0] == '#') return {};
        if (word == "v") return vertex(rest);
        if (word == "f" || word == "fo") return face(rest);
        std::array<double, 3> values{};
        if (word == "vn") {
            LUCARNE_TRY(numbers(rest, values, 3));
            mesh_.normals.emplace_back(values[0], values[1], values[2]);
        } else if (word == "vt") {
            LUCARNE_TRY(numbers(rest, values, 1));
            mesh_.coordinates.emplace_back(values[0], values[1]);
        } else if (word == "mtllib") {
            library(rest);
        } else if (word == "usemtl") {
            material_ = material(trimmed(rest));
        } else {
            other_ += word == "l" || word == "p" || word == "curv" || word == "surf" || word == "call";
            strange_ = strange_ || !(is_one_of(kNumbered, word) || is_one_of(kNamed, word));
        }
        return {};
    }

    /// Reads as many numbers as there is room for, but at least `least`. Returns how many.
    Result<size_t> numbers(std::string_view rest, std::span<double> values, size_t least) const {
        size_t count = 0;
        for (auto word = next_word(rest); !word.empty() && word[0] != '#'; word = next_word(rest)) {
            if (count == values.size()) break;
            const auto value = parse_number<double>(word);
            if (!value) return wrong(fmt::format("has '{}' for a number", printable(word)));
            values[count++] = *value;
        }
        if (count < least) return wrong("has too few numbers");
        return count;
    }

    Result<void> vertex(std::string_view rest) {
        std::array<double, 7> values{};
        LUCARNE_ASSIGN(const size_t count, numbers(rest, values, 3));
        if (mesh_.positions.size() == kNone) return wrong("is one vertex too many");
        mesh_.positions.emplace_back(values[0], values[1], values[2]);
        // x y z, x y z w, x y z r g b, x y z w r g b
        if (count >= 6) {
            raw_colors_.resize(mesh_.positions.size() - 1, glm::vec3(-1.0f));
            const size_t at = count - 3;
            raw_colors_.emplace_back(values[at], values[at + 1], values[at + 2]);
        }
        return {};
    }

    /// Colours range from 0 to 1 (a white may be slightly more through rounding), or from 0 to 255 if any is
    /// larger.
    void finish_colors() {
        if (raw_colors_.empty()) return;
        raw_colors_.resize(mesh_.positions.size(), glm::vec3(-1.0f));
        float largest = 0;
        for (const auto& c : raw_colors_) largest = std::max({largest, c.x, c.y, c.z});
        const float white = largest > 1.5f ? 1.0f : 255.0f;
        for (const auto& c : raw_colors_) {
            const auto byte = [&](float v) {
                return static_cast<uint8_t>(v >= 0 ? std::lround(std::min(v * white, 255.0f)) : kNoColor[0]);
            };
            mesh_.colors.push_back({byte(c.x), byte(c.y), byte(c.z)});
        }
    }

    /// Converts an index, which counts from 1, or backwards from -1 for the last entry above, to one that
    /// counts from 0. The entry may stand further down in the file. Returns kNowhere if there can be no such
    /// entry.
    Result<uint32_t> index(std::string_view word, size_t above, std::string_view of) const {
        const auto number = parse_number<int64_t>(word);
        if (!number) return wrong(fmt::format("has '{}' for the number of a {}", printable(word), of));
        const int64_t at = *number > 0 ? *number - 1 : *number + static_cast<int64_t>(above);
        return *number == 0 || at < 0 || at > kNowhere ? kNowhere : static_cast<uint32_t>(at);
    }

    Result<void> face(std::string_view rest) {
        polygon_.clear();
        bool late = false;  // names vertices further down in the file
        for (auto word = next_word(rest); !word.empty() && word[0] != '#'; word = next_word(rest)) {
            std::array<std::string_view, 3> parts;
            for (size_t i = 0; i < 3; ++i) {
                const size_t slash = word.find('/');
                parts[i] = word.substr(0, slash);
                word.remove_prefix(slash == word.npos ? word.size() : slash + 1);
            }
            Corner corner;
            const size_t above = mesh_.positions.size();
            LUCARNE_ASSIGN(corner.position, index(parts[0], above, "vertex"));
            if (corner.position == kNowhere)
                return wrong(fmt::format("names vertex {}, of {} above it", parts[0], above));
            late = late || corner.position >= above;
            if (!parts[1].empty()) {
                LUCARNE_ASSIGN(corner.coordinate,
                               index(parts[1], mesh_.coordinates.size(), "texture coordinate"));
            }
            if (!parts[2].empty()) {
                LUCARNE_ASSIGN(corner.normal, index(parts[2], mesh_.normals.size(), "normal"));
            }
            polygon_.push_back(corner);
        }
        if (input_.open_line() && !whole()) return wrong("is half a face");
        ++faces_;
        if (late) {
            late_faces_.push_back({line_, late_corners_.size(), polygon_.size(), material_});
            late_corners_.insert(late_corners_.end(), polygon_.begin(), polygon_.end());
        } else {
            mesh_.add(polygon_, material_, std::nullopt);
        }
        return {};
    }

    /// Adds the faces whose vertices stand below them. Clears the indices of normals and coordinates that
    /// never came.
    Result<void> finish_faces() {
        for (const LateFace& face : late_faces_) {
            const auto polygon = std::span(late_corners_).subspan(face.first, face.corners);
            const auto lost = std::ranges::find_if(
                polygon, [&](const Corner& c) { return c.position >= mesh_.positions.size(); });
            if (lost == polygon.end()) {
                mesh_.add(polygon, face.material, std::nullopt);
                continue;
            }
            line_ = face.line;
            if (!salvage_)
                return wrong(fmt::format("names vertex {}, of {}", uint64_t{lost->position} + 1,
                                         mesh_.positions.size()));
            add_loss(losses_, kDamagedLines, 1);
        }
        const auto forget = [&](std::vector<Corners>& list, size_t there) {
            for (Corners& corners : list)
                for (uint32_t& named : corners) {
                    if (named == kNone || named < there) continue;
                    named = kNone;
                    ++missing_;
                }
        };
        forget(mesh_.coordinate_corners, mesh_.coordinates.size());
        forget(mesh_.normal_corners, mesh_.normals.size());
        return {};
    }

    /// Returns whether the last corner is complete: it has the same kinds of indices as the first.
    bool whole() const {
        if (polygon_.size() < 3) return false;
        const Corner &first = polygon_.front(), &last = polygon_.back();
        return (first.coordinate == kNone) == (last.coordinate == kNone) &&
               (first.normal == kNone) == (last.normal == kNone);
    }

    /// The rest of the line is one name, which may hold blanks, or several names.
    void library(std::string_view rest) {
        const auto take = [&](std::string_view name) {
            std::filesystem::path path;
            const auto text = companions_.text(name, path);
            if (text) read_materials(*text, path.parent_path(), companions_, mesh_, materials_);
        };
        rest = trimmed(rest);
        const std::string small = lower(rest);
        const bool quoted = rest.find('"') != rest.npos;
        if (!quoted && small.ends_with(".mtl") && small.find(".mtl ") == small.npos) return take(rest);
        while (!(rest = trimmed(rest)).empty()) {
            const size_t close = rest.front() == '"' ? rest.find('"', 1) : rest.npos;
            if (close == rest.npos) {
                take(next_word(rest));
            } else {
                take(rest.substr(1, close - 1));
                rest.remove_prefix(close + 1);
            }
        }
    }
    /// Returns the number of a material, of one whose name differs in case if there is no other, or kNone.
    uint32_t material(std::string_view name) const {
        const auto found = materials_.find(name);
        if (found != materials_.end()) return found->second;
        for (const auto& [theirs, number] : materials_)
            if (same_letters(theirs, name)) return number;
        return kNone;
    }

    static constexpr uint32_t kNowhere = kNone - 1;  ///< beyond the end of every list
    struct LateFace {
        uint64_t line = 0;
        size_t first = 0, corners = 0;  ///< in late_corners_
        uint32_t material = kNone;
    };

    std::string name_;
    bool salvage_;
    BufferedInput input_;
    Mesh mesh_;
    Companions companions_;
    std::map<std::string, uint32_t, std::less<>> materials_;
    std::vector<glm::vec3> raw_colors_;
    std::vector<Corner> polygon_, late_corners_;
    std::vector<LateFace> late_faces_;
    Losses losses_;
    uint32_t material_ = kNone;
    bool strange_ = false;  ///< saw words that an OBJ of vertices has no need for
    uint64_t line_ = 0, other_ = 0, faces_ = 0, missing_ = 0;
};

Result<std::unique_ptr<PointSource>> open_obj(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    ObjParser parser(file, options.salvage);
    LUCARNE_TRY(parser.parse());
    Mesh& mesh = parser.mesh();
    ScanInfo info;
    info.path = file->path().string();
    info.file_bytes = file->size();
    info.modified = file->modified();
    set_unit(info, options, std::nullopt);
    info.losses = parser.losses();
    MeshNotes& notes = info.notes.mesh.emplace();
    notes.faces = parser.faces();
    notes.other_statements = parser.other();
    notes.missing_corners = parser.missing();
    if (parser.other() > 0)
        log::warn("{}: {} lines, points, curves and calls are left out", info.path, parser.other());
    if (parser.missing() > 0)
        log::warn("{}: corners name {} texture coordinates or normals that are not there, they have none",
                  info.path, parser.missing());
    mesh.finish();
    if (parser.faces() > 0 && mesh.triangles.empty() && !options.quiet)
        log::warn("{}: has no whole face with an area; its vertices are read", info.path);
    const bool vertices = options.mesh.vertices || mesh.triangles.empty();
    info.format = fmt::format("OBJ, {}", vertices ? "vertices" : "mesh");
    if (vertices) return vertices_only(std::move(mesh), std::move(info));
    return sampled(std::move(mesh), std::move(info), parser.state(), options);
}

Result<Mesh> load_obj(std::shared_ptr<const ByteSource> file, const ReadOptions& options) {
    ObjParser parser(file, options.salvage);
    LUCARNE_TRY(parser.parse());
    parser.mesh().finish();
    return std::move(parser.mesh());
}

/// Returns whether the first statement of the text is one of OBJ's, and not a header of rows ("v x y z").
bool is_obj(std::string_view head) {
    auto line = first_statement(head);
    const auto word = next_word(line), next = next_word(line);
    const bool number = !next.empty() && (text::is_digit(next[0]) || next.find_first_of("+-.") == 0);
    return (is_one_of(kNumbered, word) && number) ||
           (is_one_of(kNamed, word) && (word == "s" ? number || next == "off" : !next.empty()));
}

}  // namespace

const Format& obj_format() {
    static constexpr Format kFormat{"OBJ", ".obj", is_obj, open_obj, nullptr, true, load_obj};
    return kFormat;
}

}  // namespace lucarne::io
