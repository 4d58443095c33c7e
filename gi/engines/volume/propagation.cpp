#include "gi/engines/volume/propagation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr uint32_t kIterationsAtOnce = 8;
constexpr size_t kRowsATask = 64, kFacesAtOnce = 4096;
constexpr uint32_t kOutside = 0xffffffffu;

constexpr float kY0 = 0.28209479f, kY1 = 0.48860251f;  // of the real spherical harmonics
/// The integral of Y00 * kWhole over all directions is 1.
constexpr float kWhole = 3.54490770f;
/// A cosine with a flux of 1: Y00 / pi times pi, and Y1 / pi times 2 pi / 3.
constexpr float kCosine0 = kY0, kCosine1 = kY1 * 2 / 3;

}  // namespace

/// Integrates over the five faces of the neighbour, seen from the middle of the voxel: what meets a face goes
/// on as a cosine about the face's normal.
Propagation::Step Propagation::make_step() {
    constexpr int kParts = 64;
    double far = 0, far_x = 0, side = 0, side_x = 0, side_y = 0;  // solid angle; direction times solid angle
    for (int i = 0; i < kParts; ++i)
        for (int j = 0; j < kParts; ++j) {
            const double u = (i + .5) / kParts - .5, v = (j + .5) / kParts - .5;
            const double area = 1.0 / (kParts * kParts);
            const double far2 = 1.5 * 1.5 + u * u + v * v;
            far += area * 1.5 / (far2 * std::sqrt(far2));
            far_x += area * 1.5 * 1.5 / (far2 * far2);
            // The face at y = .5, of which the middle is at x = 1.
            const double x = 1 + u, side2 = x * x + .25 + v * v;
            side += area * .5 / (side2 * std::sqrt(side2));
            side_x += area * .5 * x / (side2 * side2);
            side_y += area * .5 * .5 / (side2 * side2);
        }
    const double whole = far + 4 * side, exact = 4 * M_PI / 6 / whole;  // of the quadrature
    Step step;
    step.flux_flux = static_cast<float>(kCosine0 * kY0 * whole * exact);
    step.flux_along = static_cast<float>(kCosine0 * kY1 * (far_x + 4 * side_x) * exact);
    step.along_flux = static_cast<float>(kCosine1 * kY0 * far * exact);
    step.along_along = static_cast<float>(kCosine1 * kY1 * far_x * exact);
    step.side_side = static_cast<float>(kCosine1 * kY1 * 2 * side_y * exact);
    return step;
}

Propagation::Propagation(const Space& space) : space_(space), step_(make_step()) {
    const Grid& grid = space.grid();
    for (const Face& face : space.faces.all()) {
        const glm::ivec3 cell = space.cell_before(face);
        cells_.push_back(grid.holds(cell) ? grid.number(cell) : kOutside);
    }
}

void Propagation::inject(const glm::ivec3& cell, const glm::vec3& normal, const glm::vec3& flux) {
    Lobe& lobe = now_[space_.grid().number(cell)];
    const Vector light{flux.x, flux.y, flux.z, 0};
    lobe.bands[0] += kCosine0 * light;
    for (int axis = 0; axis < 3; ++axis)
        lobe.bands[static_cast<size_t>(axis) + 1] += kCosine1 * normal[axis] * light;
}

void Propagation::begin(std::span<const glm::vec3> radiance, uint32_t iterations) {
    const Grid& grid = space_.grid();
    now_.assign(grid.cells(), {});
    next_.assign(grid.cells(), {});
    arrived_.assign(cells_.size(), glm::vec3(0.0f));
    left_ = iterations;
    const float area = grid.voxel * grid.voxel;
    for (size_t face = 0; face < cells_.size(); ++face)
        if (cells_[face] != kOutside && radiance[face] != glm::vec3(0.0f))
            inject(grid.cell(cells_[face]), space_.faces.all()[face].normal, kPi * area * radiance[face]);
}

/// Adds what comes to a cell from its neighbours along an axis, which the compiler knows: with one loop over
/// all sides, lobes stayed in memory.
template <size_t axis>
void Propagation::add_neighbours(const glm::ivec3& cell, uint32_t number, uint32_t stride, Lobe& sum) const {
    constexpr size_t kAlong = axis + 1, kU = (axis + 1) % 3 + 1, kV = (axis + 2) % 3 + 1;
    const Step step = step_;
    const auto add = [&](const Lobe& lobe, float way) {
        sum.bands[0] += step.flux_flux * lobe.bands[0] + way * step.flux_along * lobe.bands[kAlong];
        sum.bands[kAlong] += way * step.along_flux * lobe.bands[0] + step.along_along * lobe.bands[kAlong];
        sum.bands[kU] += step.side_side * lobe.bands[kU];
        sum.bands[kV] += step.side_side * lobe.bands[kV];
    };
    // From the neighbour at a side light comes the opposite way.
    if (cell[axis] + 1 < space_.grid().size[axis]) add(now_[number + stride], -1);
    if (cell[axis] > 0) add(now_[number - stride], 1);
}

void Propagation::iterate() {
    const Grid& grid = space_.grid();
    const Step& step = step_;
    const auto numbers = space_.voxels.numbers();
    // Light that meets an occupied voxel: all that would pass to it.
    parallel_ranges(cells_.size(), kFacesAtOnce, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            if (cells_[i] == kOutside) continue;
            const int side = space_.faces.all()[i].side;
            const Lobe& lobe = now_[cells_[i]];
            const Vector flux = kWhole * (step.flux_flux * lobe.bands[0] -
                                          static_cast<float>(sign_of(side)) * step.flux_along *
                                              lobe.bands[static_cast<size_t>(axis_of(side)) + 1]);
            arrived_[i] += glm::vec3(flux[0], flux[1], flux[2]);
        }
    });
    const auto rows = static_cast<size_t>(grid.size.y) * static_cast<size_t>(grid.size.z);
    const std::array<uint32_t, 3> strides = {1, static_cast<uint32_t>(grid.size.x),
                                             static_cast<uint32_t>(grid.size.x * grid.size.y)};
    parallel_ranges(rows, kRowsATask, [&](size_t first, size_t last) {
        for (size_t row = first; row < last; ++row)
            for (int x = 0; x < grid.size.x; ++x) {
                const glm::ivec3 cell(x, static_cast<int>(row) % grid.size.y,
                                      static_cast<int>(row) / grid.size.y);
                const uint32_t number = grid.number(cell);
                Lobe sum;
                if (numbers[number] == Voxels::kAir) {
                    add_neighbours<0>(cell, number, strides[0], sum);
                    add_neighbours<1>(cell, number, strides[1], sum);
                    add_neighbours<2>(cell, number, strides[2], sum);
                }
                next_[number] = sum;
            }
    });
    std::swap(now_, next_);
}

bool Propagation::advance() {
    for (uint32_t i = 0; i < kIterationsAtOnce && left_ > 0; ++i, --left_) iterate();
    return left_ > 0;
}

std::vector<glm::vec3> Propagation::irradiance() const {
    const float area = space_.grid().voxel * space_.grid().voxel;
    std::vector<glm::vec3> found(arrived_.size());
    // Lobes of two bands are negative at their backs; sums seldom are.
    std::ranges::transform(arrived_, found.begin(),
                           [&](const glm::vec3& flux) { return glm::max(flux / area, 0.0f); });
    return found;
}

glm::vec3 Propagation::under_way() const {
    glm::dvec3 sum(0.0);
    for (const Lobe& lobe : now_)
        sum += kWhole * glm::vec3(lobe.bands[0][0], lobe.bands[0][1], lobe.bands[0][2]);
    return glm::vec3(sum);
}

}  // namespace lucarne::gi::volume
