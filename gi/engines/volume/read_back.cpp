#include "gi/engines/volume/read_back.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kPixelsAtOnce = 4096;
/// Along an axis, the faces of a surface are looked for so many voxels before and behind it: discs of one
/// wall touch up to three layers.
constexpr int kLayers = 2;
constexpr std::array<int, 5> kLayerOrder = {0, 1, -1, 2, -2};  // the nearest first
static_assert(kLayerOrder.size() == 2 * kLayers + 1);
/// A face that stands for a point as well as this needs no comparison with others of its column.
constexpr float kLikeEnough = 0.6f;
/// Air before a point is looked for in steps of half a voxel.
constexpr int kMostSteps = 12;
/// Faces farther than this from the plane of the point belong to other surfaces, in voxels.
constexpr float kOffPlane = 1.0f;
/// Faces whose surface differs more than this (cosine) look another way.
constexpr float kOtherWay = 0.2f;
/// How much faces count that look another way than a point about which no others are.
constexpr float kAnyWay = 0.02f;
/// Sides that the point hardly faces are left out: squares of the normal's components below this.
constexpr float kLeastShare = 0.02f;
/// Faces with less weight than this in all are too few.
constexpr float kLeastWeight = 1e-3f;

/// A fine level's light fades out over so many voxels, and ends so many before its border, beyond which it
/// does not know what there is.
constexpr float kFading = 4, kUncertain = 2;
/// A level that ends so many voxels of the whole space or less before its end ends with it.
constexpr float kSameEnd = 0.5f;

/// Irradiance and weights of faces.
struct Sum {
    glm::vec3 light{0.0f};
    float weights = 0;
    void add(const glm::vec3& value, float weight) {
        light += weight * value;
        weights += weight;
    }
};

class Reader {
 public:
    Reader(const Space& space, std::span<const glm::vec3> irradiance, const SurfacePoint& at, Sights& sights)
        : space_(space),
          irradiance_(irradiance),
          at_(at),
          sights_(sights),
          place_(space.grid().place(at.position)) {
        find_air();
    }
    Reader(const Space& space, std::span<const glm::vec3> irradiance, const SurfacePoint& at, Sights& sights,
           const glm::ivec3& air)
        : space_(space),
          irradiance_(irradiance),
          at_(at),
          sights_(sights),
          place_(space.grid().place(at.position)),
          air_(air),
          has_air_(true) {}

    Sum read() const {
        Sum sum;
        if (!has_air_) return nearby();
        for (int axis = 0; axis < 3; ++axis) {
            const float share = at_.normal[axis] * at_.normal[axis];
            if (share < kLeastShare) continue;
            const Sum seen = along(side_of(axis, at_.normal[axis]));
            if (seen.weights > kLeastWeight) sum.add(seen.light / seen.weights, share);
        }
        return sum.weights > 0 ? sum : nearby();
    }

 private:
    /// Interpolates between the four columns of voxels about the point, along the axis of a side.
    Sum along(int side) const {
        const int axis = axis_of(side), u = (axis + 1) % 3, v = (axis + 2) % 3;
        const float x = place_[u] - 0.5f, y = place_[v] - 0.5f;
        const float low_x = std::floor(x), low_y = std::floor(y);
        Sum sum;
        for (int k = 0; k < 4; ++k) {
            glm::ivec3 cell;
            cell[axis] = static_cast<int>(std::floor(place_[axis]));
            cell[u] = static_cast<int>(low_x) + (k & 1);
            cell[v] = static_cast<int>(low_y) + (k >> 1);
            const float share = (k & 1 ? x - low_x : 1 - x + low_x) * (k >> 1 ? y - low_y : 1 - y + low_y);
            add_column(cell, side, share, sum);
        }
        return sum;
    }

    /// Adds the face of a column that is nearest to the plane of the point.
    void add_column(const glm::ivec3& middle, int side, float share, Sum& sum) const {
        float best = 0;
        uint32_t found = Faces::kNone;
        for (const int layer : kLayerOrder) {
            const glm::ivec3 cell = middle + layer * step_of(side);
            const uint32_t voxel = space_.voxels.at(cell);
            if (voxel == Voxels::kAir) continue;
            const uint32_t face = space_.faces.at(voxel, side);
            if (face == Faces::kNone) continue;
            const float likeness = likeness_of(space_.faces.all()[face]);
            if (likeness <= best || !sights_.see(air_, cell + step_of(side))) continue;
            best = likeness;
            found = face;
            if (best > kLikeEnough) break;
        }
        // A face outside the four columns' overlap still counts a little, where all others are missing.
        if (found != Faces::kNone) sum.add(irradiance_[found], (share + 0.01f) * best);
    }

    /// Returns how well a face stands for the surface of the point, 0 to 1.
    float likeness_of(const Face& face) const {
        const float agreement = glm::dot(face.normal, at_.normal);
        if (agreement <= kOtherWay) return 0;
        const float away = std::abs(glm::dot(at_.normal, face.position - at_.position)) /
                           (kOffPlane * space_.grid().voxel + at_.radius);
        return std::max(1 - away, 0.0f) * agreement;
    }

    /// Returns the mean of faces about the point that see the air before it: of those next to it that look
    /// its way, else of all within two voxels. Where voxels show no air at all, between things as small as
    /// voxels, faces count that look its way.
    Sum nearby() const {
        Sum sum = within(1, 0);
        if (!(sum.weights > 0)) sum = within(2, has_air_ ? kAnyWay : 0);
        if (sum.weights > 0) {
            sum.light /= sum.weights;
            sum.weights = 1;
        }
        return sum;
    }
    /// Adds up faces so many voxels away or less; those that look another way count `other_way`.
    Sum within(int reach, float other_way) const {
        const glm::ivec3 middle(glm::floor(place_));
        const int side_length = 2 * reach + 1;
        Sum sum;
        for (int i = 0; i < side_length * side_length * side_length; ++i) {
            const glm::ivec3 away =
                glm::ivec3(i % side_length, i / side_length % side_length, i / (side_length * side_length)) -
                reach;
            const uint32_t voxel = space_.voxels.at(middle + away);
            if (voxel == Voxels::kAir) continue;
            for (int side = 0; side < kSides; ++side) {
                const uint32_t number = space_.faces.at(voxel, side);
                if (number == Faces::kNone) continue;
                const Face& face = space_.faces.all()[number];
                const float agreement = std::max(glm::dot(face.normal, at_.normal), other_way);
                if (!(agreement > 0)) continue;
                if (has_air_ && !sights_.see(air_, middle + away + step_of(side))) continue;
                const glm::vec3 offset = (face.position - at_.position) / space_.grid().voxel;
                sum.add(irradiance_[number], agreement / (0.1f + glm::dot(offset, offset)));
            }
        }
        return sum;
    }

    /// Finds air before the point: on the way to the viewer, who sees it, or else along its normal. Faces
    /// count that border on this air. Rims of walls on the other side of a corner may lie in the plane of the
    /// point.
    void find_air() {
        for (const glm::vec3& way : {at_.viewer, at_.normal})
            for (int step = 1; step <= kMostSteps; ++step) {
                air_ = glm::ivec3(glm::floor(place_ + 0.5f * static_cast<float>(step) * way));
                has_air_ = space_.grid().holds(air_) && space_.voxels.is_air(air_);
                if (has_air_) return;
            }
    }

    const Space& space_;
    std::span<const glm::vec3> irradiance_;
    const SurfacePoint& at_;
    Sights& sights_;
    glm::vec3 place_;    ///< of the point, in units of voxels
    glm::ivec3 air_{0};  ///< the cell of air before it
    bool has_air_ = false;
};

/// Whether there may be faces about a position. Points far outside the grid do not fit into whole numbers.
bool is_near(const Grid& grid, const glm::vec3& position) {
    const glm::vec3 place = grid.place(position), size(grid.size);
    for (int axis = 0; axis < 3; ++axis)
        if (!(place[axis] > -kLayers - 1 && place[axis] < size[axis] + kLayers + 1)) return false;
    return true;
}

glm::vec4 mean_of(const Sum& sum) {
    return sum.weights > 0 ? glm::vec4(sum.light / sum.weights, 1) : glm::vec4(0.0f);
}

glm::vec4 found_by(const LitLevel& level, Sights& sights, const SurfacePoint& at) {
    return is_near(level.space->grid(), at.position)
               ? mean_of(Reader(*level.space, level.irradiance, at, sights).read())
               : glm::vec4(0.0f);
}

/// Returns how much a level counts at a position, 0 to 1: less and less near its border. Where it ends
/// because the whole space ends there, it counts up to the end.
float share_of(const Grid& grid, const Grid& whole, const glm::vec3& position) {
    if (!grid.part) return 1;
    const glm::vec3 place = grid.place(position), low = grid.place(whole.low),
                    high = grid.place(whole.position(glm::vec3(whole.size)));
    const float same = kSameEnd * whole.voxel / grid.voxel;
    float least = kFading;
    for (int axis = 0; axis < 3; ++axis) {
        const auto size = static_cast<float>(grid.size[axis]);
        if (low[axis] < -same) least = std::min(least, place[axis] - kUncertain);
        if (high[axis] > size + same) least = std::min(least, size - kUncertain - place[axis]);
    }
    return std::max(least, 0.0f) / kFading;
}

/// Returns the irradiance of a point by all levels; in w: 1 if faces were found, else 0. `sights`: of each.
glm::vec4 irradiance_by(std::span<const LitLevel> levels, std::span<Sights> sights, const SurfacePoint& at) {
    glm::vec4 sum(0.0f);
    float left = 1;
    for (size_t i = levels.size(); i-- > 0 && left > 0;) {
        const float share = share_of(levels[i].space->grid(), levels[0].space->grid(), at.position);
        if (!(share > 0)) continue;
        const glm::vec4 found = found_by(levels[i], sights[i], at);
        if (!(found.w > 0)) continue;
        sum += left * share * found;
        left *= 1 - share;
    }
    return sum.w > 0 ? sum / sum.w : sum;
}

}  // namespace

glm::vec4 irradiance_at(const Space& space, std::span<const glm::vec3> irradiance, const SurfacePoint& at,
                        const glm::ivec3& air, Sights& sights) {
    return is_near(space.grid(), at.position) ? mean_of(Reader(space, irradiance, at, sights, air).read())
                                              : glm::vec4(0.0f);
}

std::vector<glm::vec4> read_back(std::span<const LitLevel> levels, std::span<const SurfacePoint> surfaces,
                                 std::span<const Material> materials, size_t& missing) {
    std::vector<glm::vec4> light(surfaces.size(), glm::vec4(0.0f));
    std::atomic<size_t> none{0};
    parallel_ranges(surfaces.size(), kPixelsAtOnce, [&](size_t first, size_t last) {
        size_t without = 0;
        std::vector<Sights> sights;
        for (const LitLevel& level : levels) sights.emplace_back(*level.space);
        for (size_t i = first; i < last; ++i) {
            const SurfacePoint& at = surfaces[i];
            if (!(at.radius > 0)) continue;
            const glm::vec4 found = irradiance_by(levels, sights, at);
            without += !(found.w > 0);
            const Reflectance r = make_reflectance(materials[at.material % materials.size()], at.albedo);
            light[i] = glm::vec4((r.kd + r.ks) / kPi * glm::vec3(found), 0);
        }
        none += without;
    });
    missing = none;
    return light;
}

}  // namespace lucarne::gi::volume
