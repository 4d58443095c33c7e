#include "gi/volume/faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "gi/tree/coverage.h"
#include "gi/volume/blocks.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kVoxelsATask = 512, kFacesATask = 1024, kFacesAtOnce = 8 * kFacesATask;
constexpr size_t kSurfelsATask = 65536;
/// Discs of one wall touch up to this many layers of voxels below the one that borders on air.
constexpr int kLayersBelow = 2;
constexpr uint32_t kNoFace = Faces::kNone;
/// A sheet that covers this share of a voxel's face hides what is below it.
constexpr float kHiding = 0.25f;
/// A sheet is as thick as the radius of its surfels, but at least and at most so many voxels. What is half as
/// much deeper again does not belong to it.
constexpr float kThinnest = 0.1f, kThickest = 0.4f;
/// At a face to which no surfel belongs, those within 80 degrees of it are seen.
constexpr float kSteepest = 0.17f;
/// The air before a surfel's side is looked for so many blocks above it, out of those that its disc touches.
constexpr float kAbove = 1.5f;
/// A slanted surface in a voxel is up to so many times as large as a side of the voxel.
constexpr float kMostSlanted = 2;

/// A part of a surfel's side that a face may show.
struct Candidate {
    uint32_t surfel;
    bool back;
    bool beside;  ///< see Owned
    float whole;  ///< area of the part, m^2
    float radius;
    glm::vec3 position, normal;  ///< the normal is that of the side
    float area = whole;          ///< what of it is seen, m^2
    float height = 0;            ///< along the mean normal, m
    bool open = false;           ///< that its light reaches the air before the face is known
};

/// A voxel whose surfels a face stands for. Of one beside it, in which a wall stands, only the areas count:
/// on the other side of the wall there may be other light.
struct Owned {
    uint32_t voxel;
    bool beside;
};
struct Owners {
    std::vector<size_t> starts;  ///< by face, and the end
    std::vector<Owned> voxels;   ///< sorted by face and voxel
};

/// Returns the face that shows what belongs to a side of a voxel: its own, that of a voxel above it, or,
/// where a wall stands on its voxel, that of one beside it. kNoFace if it is hidden.
uint32_t owner_of(const Voxels& voxels, const Faces& faces, const glm::ivec3& cell, int side, bool& beside) {
    const auto face_at = [&](const glm::ivec3& at) {
        const uint32_t voxel = voxels.at(at);
        return voxel == Voxels::kAir ? kNoFace : faces.at(voxel, side);
    };
    const glm::ivec3 up = step_of(side);
    beside = false;
    for (int layer = 0; layer <= kLayersBelow; ++layer)
        if (const uint32_t face = face_at(cell + layer * up); face != kNoFace) return face;
    beside = true;
    const glm::ivec3 u = step_of(2 * ((axis_of(side) + 1) % 3)), v = step_of(2 * ((axis_of(side) + 2) % 3));
    for (const glm::ivec3& way : {u, -u, v, -v, u + v, u - v, v - u, -u - v})
        for (const int layer : {0, 1, -1})
            if (const uint32_t face = face_at(cell + way + layer * up); face != kNoFace) return face;
    return kNoFace;
}

Owners find_owners(const Voxels& voxels, const Faces& faces) {
    struct Owner {
        uint32_t face = kNoFace;
        bool beside = false;
    };
    const size_t count = voxels.occupied().size();
    std::vector<std::array<Owner, kSides>> owners(count);
    parallel_ranges(count, kVoxelsATask, [&](size_t first, size_t last) {
        for (size_t voxel = first; voxel < last; ++voxel)
            for (int side = 0; side < kSides; ++side) {
                Owner& owner = owners[voxel][static_cast<size_t>(side)];
                const glm::ivec3 cell = voxels.grid().cell(voxels.occupied()[voxel]);
                owner.face = owner_of(voxels, faces, cell, side, owner.beside);
            }
    });
    Owners found;
    found.starts.assign(faces.all().size() + 1, 0);
    for (const auto& sides : owners)
        for (const Owner& owner : sides)
            if (owner.face != kNoFace) ++found.starts[owner.face + 1];
    for (size_t i = 1; i < found.starts.size(); ++i) found.starts[i] += found.starts[i - 1];
    found.voxels.resize(found.starts.back());
    std::vector<size_t> next(found.starts.begin(), found.starts.end() - 1);
    for (uint32_t voxel = 0; voxel < count; ++voxel)
        for (const Owner& owner : owners[voxel])
            if (owner.face != kNoFace) found.voxels[next[owner.face]++] = {voxel, owner.beside};
    return found;
}

/// The parts of surfels in each voxel, grouped by the axis that their normals are nearest to: a face reads
/// those of one axis. Within a group they are sorted by surfel.
class PartsByAxis {
 public:
    /// `normals`: of the surfels, decoded.
    PartsByAxis(const Voxels& voxels, std::span<const glm::vec3> normals)
        : parts_(voxels.all_parts()), starts_(voxels.occupied().size()) {
        if (starts_.empty()) return;
        const SurfelPart* const all = voxels.parts(0).data();
        parallel_ranges(starts_.size(), kVoxelsATask, [&](size_t first, size_t last) {
            std::array<std::vector<SurfelPart>, 3> groups;
            for (size_t voxel = first; voxel < last; ++voxel) {
                const auto own = voxels.parts(static_cast<uint32_t>(voxel));
                for (const SurfelPart& part : own)
                    groups[static_cast<size_t>(largest_axis(normals[part.surfel]))].push_back(part);
                auto at = static_cast<size_t>(own.data() - all);
                for (size_t axis = 0; axis < 3; ++axis) {
                    starts_[voxel][axis] = at;
                    std::ranges::copy(groups[axis], parts_.begin() + static_cast<ptrdiff_t>(at));
                    at += groups[axis].size();
                    groups[axis].clear();
                }
                starts_[voxel][3] = at;
            }
        });
    }
    std::span<const SurfelPart> of(uint32_t voxel, int axis) const {
        const auto& starts = starts_[voxel];
        const auto group = static_cast<size_t>(axis);
        return std::span(parts_).subspan(starts[group], starts[group + 1] - starts[group]);
    }

 private:
    std::vector<SurfelPart> parts_;
    std::vector<std::array<size_t, 4>> starts_;  ///< by voxel and axis; and the end
};

/// Finds what faces show.
class Finder {
 public:
    /// `normals`: of the surfels, decoded.
    Finder(const Voxels& voxels, const PartsByAxis& parts, std::span<const FlatSurfel> surfels,
           std::span<const glm::vec3> normals)
        : voxels_(voxels), parts_(parts), surfels_(surfels), normals_(normals) {}

    /// Sets what a face shows; `owned`: the voxels that it stands for.
    void set_face(Face& face, std::span<const Owned> owned, std::vector<Faces::Shown>& shown) {
        const glm::vec3 outward = face.normal;
        collect(owned, face.side);
        const bool own = std::ranges::any_of(candidates_, [](const Candidate& c) { return !c.beside; });
        if (!own) {
            candidates_.clear();
            collect_slanted(face.voxel, face.side, outward);
        }
        if (candidates_.empty()) return;
        weigh_outermost(mean_normal(outward));
        float all = 0, sum = 0;
        glm::vec3 position(0.0f);
        for (const Candidate& c : candidates_) {
            all += c.area;
            sum += c.beside ? 0 : c.area;
            position += c.area * c.position;
        }
        if (!(sum > 0)) return;
        face.normal = mean_normal(outward);
        face.position = position / all;
        if (!own) {
            for (const Candidate& c : candidates_)
                if (c.area > 0) shown.push_back({c.surfel, c.back ? 1u : 0u, c.area / sum, c.area / sum});
            return;
        }
        find_open(face);
        const float beside = all - sum;
        sum = show_below(sum, glm::dot(face.normal, outward));
        face.area = sum + beside;
        // What may be behind a wall is taken to be as bright as the rest.
        float unknown = 0;
        for (const Candidate& c : candidates_) unknown += c.beside && !c.open ? c.area : 0;
        for (const Candidate& c : candidates_) {
            const float weight = c.beside ? 0 : c.area / sum;
            const float from = c.beside ? (c.open ? c.area : 0) : c.open ? c.whole : c.area;
            const float sent = (from + weight * unknown) / face.area;
            if (sent > 0) shown.push_back({c.surfel, c.back ? 1u : 0u, weight, sent});
        }
    }

 private:
    /// Finds those candidates that lie below others or beside the face, but not behind a wall: free blocks
    /// lead from them to the air before the face.
    void find_open(const Face& face) {
        const auto asked = [](const Candidate& c) { return c.beside || c.area < c.whole; };
        if (std::ranges::none_of(candidates_, asked)) return;
        const glm::ivec3 step = step_of(face.side);
        const BlockRows reached =
            connected_with(voxels_.blocks_about(face.voxel), 13 + step.x + 3 * step.y + 9 * step.z);
        const Grid& grid = voxels_.grid();
        const glm::vec3 low(grid.cell(voxels_.occupied()[face.voxel]) - 1);
        constexpr auto kBlocks = static_cast<float>(kBlocksAlong);
        for (Candidate& c : candidates_)
            if (asked(c))
                c.open = holds(reached, glm::ivec3(glm::floor(kBlocks * (grid.place(c.position) - low) +
                                                              kAbove * c.normal)));
    }

    /// Shows what is seen of open sheets below the outermost one: as much as it leaves free of the voxel.
    /// `shown`: area so far, m^2; `cosine`: of the surface to the side. Returns the area then.
    float show_below(float shown, float cosine) {
        float below = 0;
        for (const Candidate& c : candidates_) below += c.open && !c.beside ? c.whole - c.area : 0;
        const float voxel = voxels_.grid().voxel;
        const float room = voxel * voxel * std::min(1 / std::max(cosine, 1e-3f), kMostSlanted) - shown;
        if (!(below > 0) || !(room > 0)) return shown;
        const float share = std::min(room / below, 1.0f);
        for (Candidate& c : candidates_)
            if (c.open && !c.beside) c.area += share * (c.whole - c.area);
        return shown + share * below;
    }

    /// Collects the sides of surfels that belong to this side of voxels.
    void collect(std::span<const Owned> owned, int side) {
        candidates_.clear();
        for (const auto& [voxel, beside] : owned) {
            const glm::ivec3 cell = voxels_.grid().cell(voxels_.occupied()[voxel]);
            const int axis = axis_of(side);
            for (const SurfelPart& part : parts_.of(voxel, axis)) {
                const glm::vec3& normal = normals_[part.surfel];
                add(part, cell, normal, side_of(axis, normal[axis]) != side, 1);
                candidates_.back().beside = beside;
            }
        }
    }

    /// Collects the sides that are seen from the side, if none belongs to it: at the steps of slanted walls.
    void collect_slanted(uint32_t voxel, int side, const glm::vec3& outward) {
        const glm::ivec3 cell = voxels_.grid().cell(voxels_.occupied()[voxel]);
        for (const SurfelPart& part : voxels_.parts(voxel)) {
            const glm::vec3& normal = normals_[part.surfel];
            const float cosine = normal[axis_of(side)] * outward[axis_of(side)];
            if (std::abs(cosine) > kSteepest) add(part, cell, normal, cosine < 0, std::abs(cosine));
        }
    }

    void add(const SurfelPart& part, const glm::ivec3& cell, const glm::vec3& normal, bool back,
             float share) {
        const FlatSurfel& surfel = surfels_[part.surfel];
        const Grid& grid = voxels_.grid();
        // The point of the disc's plane nearest to the middle of the part, for discs larger than voxels.
        const glm::vec3 middle(surfel.x, surfel.y, surfel.z), low = grid.position(glm::vec3(cell));
        glm::vec3 position = glm::clamp(middle, low, low + grid.voxel);
        position -= normal * glm::dot(normal, position - middle);
        candidates_.push_back({part.surfel, back, false, share * part.area,
                               std::min(surfel.radius, grid.voxel), position, back ? -normal : normal});
    }

    glm::vec3 mean_normal(const glm::vec3& outward) const {
        glm::vec3 sum(0.0f);
        for (const Candidate& c : candidates_) sum += c.area * c.normal;
        const float length = glm::length(sum);
        return length > 0 ? sum / length : outward;
    }

    /// Keeps the areas of the outermost sheet, and fades out what lies below it.
    void weigh_outermost(const glm::vec3& normal) {
        float all = 0, radii = 0;
        for (Candidate& c : candidates_) {
            c.height = glm::dot(normal, c.position);
            all += c.area;
            radii += c.area * c.radius;
        }
        if (!(all > 0)) return;
        const float voxel = voxels_.grid().voxel;
        const float thickness = std::clamp(radii / all, kThinnest * voxel, kThickest * voxel);
        const auto [lowest, highest] = std::ranges::minmax(candidates_, {}, &Candidate::height);
        if (highest.height - lowest.height <= thickness) return;  // one sheet
        // Of equal heights the order of the surfels decides.
        std::ranges::stable_sort(candidates_, std::greater<>(), &Candidate::height);
        const float hiding = std::min(kHiding * voxel * voxel, 0.5f * all);
        float covered = 0, top = candidates_.front().height;
        for (const Candidate& c : candidates_) {
            covered += c.area;
            top = c.height;
            if (covered >= hiding) break;
        }
        for (Candidate& c : candidates_)
            c.area *= std::clamp(3 - 2 * (top - c.height) / thickness, 0.0f, 1.0f);
    }

    const Voxels& voxels_;
    const PartsByAxis& parts_;
    std::span<const FlatSurfel> surfels_;
    std::span<const glm::vec3> normals_;
    std::vector<Candidate> candidates_;
};

}  // namespace

/// Numbers the sides that border on air, in the order of their voxels.
void Faces::number(const Voxels& voxels) {
    const Grid& grid = voxels.grid();
    std::array<uint32_t, kSides> none;
    none.fill(kNone);
    numbers_.assign(voxels.occupied().size(), none);
    for (uint32_t voxel = 0; voxel < numbers_.size(); ++voxel) {
        const glm::ivec3 cell = grid.cell(voxels.occupied()[voxel]);
        for (int side = 0; side < kSides; ++side) {
            const glm::vec3 outward(step_of(side));
            if (!voxels.is_air(cell + step_of(side))) continue;
            numbers_[voxel][static_cast<size_t>(side)] = static_cast<uint32_t>(faces_.size());
            faces_.push_back({.voxel = voxel,
                              .side = side,
                              .position = grid.middle(cell) + 0.5f * grid.voxel * outward,
                              .normal = outward});
        }
    }
}

struct FaceMaker::State {
    struct Piece {
        std::vector<Faces::Shown> shown;
        std::vector<size_t> ends;  ///< by face
    };
    const Voxels& voxels;
    std::span<const FlatSurfel> surfels;
    Faces faces;
    Owners owners;
    std::vector<glm::vec3> normals;  ///< of the surfels, decoded
    std::optional<PartsByAxis> parts;
    std::vector<Piece> pieces;  ///< of so many faces each
    size_t done = 0;            ///< faces
};

FaceMaker::FaceMaker(const Voxels& voxels, std::span<const FlatSurfel> surfels)
    : state_(new State{voxels, surfels, {}, {}, {}, {}, {}}) {
    State& s = *state_;
    s.faces.number(voxels);
    s.owners = find_owners(voxels, s.faces);
    s.normals.resize(surfels.size());
    parallel_ranges(surfels.size(), kSurfelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) s.normals[i] = decode_octahedral(surfels[i].normal);
    });
    s.parts.emplace(voxels, s.normals);
    s.pieces.resize((s.faces.faces_.size() + kFacesATask - 1) / kFacesATask);
}

FaceMaker::~FaceMaker() = default;

bool FaceMaker::advance() {
    State& s = *state_;
    const size_t count = s.faces.faces_.size(), end = std::min(count, s.done + kFacesAtOnce);
    parallel_ranges(end - s.done, kFacesATask, [&](size_t first, size_t last) {
        Finder finder(s.voxels, *s.parts, s.surfels, s.normals);
        State::Piece& piece = s.pieces[(s.done + first) / kFacesATask];
        for (size_t i = s.done + first; i < s.done + last; ++i) {
            const size_t begin = s.owners.starts[i], after = s.owners.starts[i + 1];
            finder.set_face(s.faces.faces_[i], std::span(s.owners.voxels).subspan(begin, after - begin),
                            piece.shown);
            piece.ends.push_back(piece.shown.size());
        }
    });
    s.done = end;
    return s.done < count;
}

Faces FaceMaker::finish() {
    Faces& faces = state_->faces;
    faces.starts_.push_back(0);
    for (State::Piece& piece : state_->pieces) {
        const size_t before = faces.shown_.size();
        for (const size_t end : piece.ends) faces.starts_.push_back(before + end);
        faces.shown_.insert(faces.shown_.end(), piece.shown.begin(), piece.shown.end());
        piece = {};
    }
    return std::move(faces);
}

Faces Faces::find(const Voxels& voxels, std::span<const FlatSurfel> surfels) {
    FaceMaker maker(voxels, surfels);
    while (maker.advance()) {
    }
    return maker.finish();
}

}  // namespace lucarne::gi::volume
