#include "gi/volume/faces.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "gi/tree/coverage.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kVoxelsATask = 512;
/// Discs of one wall touch up to this many layers of voxels below the one that borders on air.
constexpr int kLayersBelow = 2;
/// A sheet that covers this share of a voxel's face hides what is below it.
constexpr float kHiding = 0.25f;
/// A sheet is as thick as the radius of its surfels, but at least and at most so many voxels. What is half as
/// much deeper again does not belong to it.
constexpr float kThinnest = 0.1f, kThickest = 0.4f;
/// At a face to which no surfel belongs, those within 80 degrees of it are seen.
constexpr float kSteepest = 0.17f;

/// A part of a surfel's side that a face may show.
struct Candidate {
    uint32_t surfel;
    bool back;
    float area;
    float radius;
    glm::vec3 position, normal;  ///< the normal is that of the side
    float height = 0;            ///< along the mean normal, m
};

/// The faces of some voxels, before they are numbered.
struct Found {
    std::vector<Face> faces;
    std::vector<Faces::Shown> shown;
    std::vector<size_t> ends;  ///< by face
};

class Finder {
 public:
    Finder(const Voxels& voxels, std::span<const FlatSurfel> surfels) : voxels_(voxels), surfels_(surfels) {}

    void add_voxel(uint32_t voxel, Found& found) {
        const Grid& grid = voxels_.grid();
        const glm::ivec3 cell = grid.cell(voxels_.occupied()[voxel]);
        for (int side = 0; side < kSides; ++side) {
            if (!voxels_.is_air(cell + step_of(side))) continue;
            add_face(voxel, cell, side, found);
        }
    }

 private:
    void add_face(uint32_t voxel, const glm::ivec3& cell, int side, Found& found) {
        const Grid& grid = voxels_.grid();
        glm::vec3 outward(0.0f);
        outward[axis_of(side)] = static_cast<float>(sign_of(side));
        Face face{.voxel = voxel,
                  .side = side,
                  .position = grid.middle(cell) + 0.5f * grid.voxel * outward,
                  .normal = outward};
        collect(cell, side);
        const bool own = !candidates_.empty();
        if (!own) collect_slanted(voxel, side, outward);
        if (!candidates_.empty()) {
            face.normal = mean_normal(outward);
            weigh_outermost(face.normal);
            face.normal = mean_normal(outward);
            float sum = 0;
            glm::vec3 position(0.0f);
            for (const Candidate& c : candidates_) {
                sum += c.area;
                position += c.area * c.position;
            }
            if (sum > 0) {
                face.position = position / sum;
                if (own) face.area = sum;
                for (const Candidate& c : candidates_)
                    if (c.area > 0) found.shown.push_back({c.surfel, c.back ? 1u : 0u, c.area / sum});
            }
        }
        found.faces.push_back(face);
        found.ends.push_back(found.shown.size());
    }

    /// Collects the sides that belong to a side of this voxel and of those below it.
    void collect(glm::ivec3 cell, int side) {
        candidates_.clear();
        for (int layer = 0; layer <= kLayersBelow; ++layer, cell -= step_of(side)) {
            const uint32_t voxel = voxels_.at(cell);
            if (voxel == Voxels::kAir) return;
            for (const SurfelPart& part : voxels_.parts(voxel)) {
                const glm::vec3 normal = decode_octahedral(surfels_[part.surfel].normal);
                const int axis = largest_axis(normal);
                if (axis == axis_of(side)) add(part, cell, normal, side_of(axis, normal[axis]) != side, 1);
            }
        }
    }

    /// Collects the sides that are seen from the side, if none belongs to it: at the steps of slanted walls.
    void collect_slanted(uint32_t voxel, int side, const glm::vec3& outward) {
        const glm::ivec3 cell = voxels_.grid().cell(voxels_.occupied()[voxel]);
        for (const SurfelPart& part : voxels_.parts(voxel)) {
            const glm::vec3 normal = decode_octahedral(surfels_[part.surfel].normal);
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
        candidates_.push_back({part.surfel, back, share * part.area, std::min(surfel.radius, grid.voxel),
                               position, back ? -normal : normal});
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
        // Of equal heights the order of the surfels decides.
        std::ranges::stable_sort(candidates_, std::greater<>(), &Candidate::height);
        const float hiding = std::min(kHiding * voxel * voxel, 0.5f * all);
        float covered = 0, top = candidates_.front().height;
        for (const Candidate& c : candidates_) {
            covered += c.area;
            top = c.height;
            if (covered >= hiding) break;
        }
        const float thickness = std::clamp(radii / all, kThinnest * voxel, kThickest * voxel);
        for (Candidate& c : candidates_)
            c.area *= std::clamp(3 - 2 * (top - c.height) / thickness, 0.0f, 1.0f);
    }

    const Voxels& voxels_;
    std::span<const FlatSurfel> surfels_;
    std::vector<Candidate> candidates_;
};

}  // namespace

Faces Faces::find(const Voxels& voxels, std::span<const FlatSurfel> surfels) {
    const size_t count = voxels.occupied().size();
    std::vector<Found> pieces((count + kVoxelsATask - 1) / kVoxelsATask);
    parallel_ranges(count, kVoxelsATask, [&](size_t first, size_t last) {
        Finder finder(voxels, surfels);
        for (size_t voxel = first; voxel < last; ++voxel)
            finder.add_voxel(static_cast<uint32_t>(voxel), pieces[first / kVoxelsATask]);
    });
    Faces faces;
    std::array<uint32_t, kSides> none;
    none.fill(kNone);
    faces.numbers_.assign(count, none);
    faces.starts_.push_back(0);
    for (Found& piece : pieces) {
        const size_t before = faces.shown_.size();
        for (const Face& face : piece.faces) {
            faces.numbers_[face.voxel][static_cast<size_t>(face.side)] =
                static_cast<uint32_t>(faces.faces_.size());
            faces.faces_.push_back(face);
        }
        for (const size_t end : piece.ends) faces.starts_.push_back(before + end);
        faces.shown_.insert(faces.shown_.end(), piece.shown.begin(), piece.shown.end());
        piece = {};
    }
    return faces;
}

}  // namespace lucarne::gi::volume
