#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/flat_surfel.h"
#include "gi/volume/voxels.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {

/// A side of an occupied voxel that borders on air, and the surface that is seen there.
struct Face {
    uint32_t voxel = 0;  ///< number of the occupied voxel
    int side = 0;
    glm::vec3 position{0.0f};  ///< middle of the surface, m
    glm::vec3 normal{0.0f};    ///< unit mean, into the air
    /// Of the surface that is seen, m^2; 0: the surface counts at another face of the voxel, or there is
    /// none.
    float area = 0;
};

/// All faces of the occupied voxels that border on air. A face shows those sides of surfels whose normals are
/// nearest to its own: a side of a surfel belongs to one face, so the two sides of a thin wall stay apart.
/// Where discs touch several layers of voxels, a face also shows what lies below it, and beside it where a
/// wall stands on the next voxel. Of several sheets above each other it shows the outermost, and sends out
/// the light of those below it, too, that are not shut off from its air.
class Faces {
 public:
    static constexpr uint32_t kNone = 0xffffffffu;

    /// The same surfels give the same faces, whatever the number of threads.
    static Faces find(const Voxels& voxels, std::span<const FlatSurfel> surfels);

    std::span<const Face> all() const { return faces_; }
    /// Returns the face at a side of an occupied voxel; kNone if that side does not border on air.
    uint32_t at(uint32_t voxel, int side) const { return numbers_[voxel][static_cast<size_t>(side)]; }
    std::span<const std::array<uint32_t, kSides>> numbers() const { return numbers_; }

    /// Part of a surfel's side that a face shows.
    struct Shown {
        uint32_t surfel : 31;
        uint32_t back : 1;  ///< the side that its normal does not point to
        float weight;
        /// The area from which light of the surfel's own leaves by this face, over the area of the face.
        float sent;
    };
    /// The parts that a face shows; their weights add up to 1. Rims of sheets, where no surfel faces the air,
    /// show none.
    std::span<const Shown> shown(uint32_t face) const {
        return std::span(shown_).subspan(starts_[face], starts_[face + 1] - starts_[face]);
    }
    /// Returns for each face the mean of value(surfel, back) over what it shows; `Value` begins as zero.
    template <class Value, class Function>
    std::vector<Value> means(const Function& value) const {
        return sums<Value>(&Shown::weight, value);
    }
    /// Returns the radiance of each face at which it sends out, over its area, all that its surfels do:
    /// radiance(surfel, back) is that of a side of a surfel by lights or emission. Sides that no light
    /// reaches lie below others, and do not darken what is seen.
    template <class Value, class Function>
    std::vector<Value> radiance_of(const Function& radiance) const {
        return sums<Value>(&Shown::sent, radiance);
    }

 private:
    friend class FaceMaker;
    template <class Value, class Function>
    std::vector<Value> sums(float Shown::*weight, const Function& value) const {
        std::vector<Value> found(faces_.size(), Value(0.0f));
        parallel_over_faces([&](uint32_t face) {
            for (const Shown& part : shown(face))
                found[face] += part.*weight * value(part.surfel, part.back != 0);
        });
        return found;
    }
    void number(const Voxels& voxels);
    template <class Body>
    void parallel_over_faces(const Body& body) const {
        parallel_ranges(faces_.size(), 1024, [&](size_t first, size_t last) {
            for (size_t face = first; face < last; ++face) body(static_cast<uint32_t>(face));
        });
    }

    std::vector<Face> faces_;
    std::vector<std::array<uint32_t, kSides>> numbers_;  ///< by occupied voxel
    std::vector<size_t> starts_;  ///< by face: the first part that it shows; and the end
    std::vector<Shown> shown_;
};

/// Faces::find() in steps.
class FaceMaker {
 public:
    /// `voxels` and `surfels` must outlive this.
    FaceMaker(const Voxels& voxels, std::span<const FlatSurfel> surfels);
    ~FaceMaker();
    /// Finds what the next faces show. Returns false when all are done.
    bool advance();
    /// Returns the faces; all must be done.
    Faces finish();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::gi::volume
