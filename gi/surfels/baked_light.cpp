#include "gi/surfels/baked_light.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/robust_bounds.h"

namespace lucarne::gi {
namespace {

constexpr int kCells = 48;              // along the longest side
constexpr int kBlur = 2;                // cells to each side
constexpr uint64_t kSampled = 400'000;  // least number of points; whole levels are sampled
constexpr size_t kMostNodes = 4096;     // limit for scans in many small parts
constexpr double kMost = 8;             // largest factor, and 1 / the least

/// Sums and counts of luminances, cell by cell.
struct Sums {
    glm::ivec3 size{0};
    std::vector<double> values, counts;

    explicit Sums(const glm::ivec3& its_size)
        : size(its_size),
          values(static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z)),
          counts(values.size()) {}
    size_t at(int x, int y, int z) const {
        assert(x >= 0 && y >= 0 && z >= 0 && x < size.x && y < size.y && z < size.z);
        return static_cast<size_t>((z * size.y + y) * size.x + x);
    }
};

/// Limits a place among cells to their range, and NaN, which damaged files hold, to 0.
glm::dvec3 within(const glm::dvec3& place, const glm::ivec3& size) {
    return glm::min(glm::max(glm::dvec3(0), place), glm::dvec3(size) - 1.0);
}

/// Applies a box filter of 2 kBlur + 1 cells along one axis.
Sums blurred(const Sums& from, int axis) {
    Sums to(from.size);
    for (int z = 0; z < from.size.z; ++z)
        for (int y = 0; y < from.size.y; ++y)
            for (int x = 0; x < from.size.x; ++x)
                for (int d = -kBlur; d <= kBlur; ++d) {
                    glm::ivec3 near(x, y, z);
                    near[axis] += d;
                    if (near[axis] < 0 || near[axis] >= from.size[axis]) continue;
                    to.values[to.at(x, y, z)] += from.values[from.at(near.x, near.y, near.z)];
                    to.counts[to.at(x, y, z)] += from.counts[from.at(near.x, near.y, near.z)];
                }
    return to;
}

/// Adds the points of a node, with the colours that engines see.
void add_node(const octree::NodeSource& source, uint32_t node, const octree::NodeData& data,
              const glm::dvec3& min, double cell, Sums& sums) {
    const octree::SourcePart part = source.part_of(node);
    const io::Schema& schema = part.header.schema;
    if (!schema.find(io::names::color)) return;
    static const Scene kPlain;
    const auto surfels = pack_surfels(part.header, source.nodes()[node], data, kPlain, part.first_scan);
    for (size_t i = 0; i < surfels.size(); ++i) {
        const glm::vec3 colour = decode_albedo(surfels[i].d);
        const glm::dvec3 position =
            io::position_of(schema, data.records.data() + i * schema.stride) * part.scale;
        const glm::dvec3 place = within((position - min) / cell, sums.size);
        const size_t at =
            sums.at(static_cast<int>(place.x), static_cast<int>(place.y), static_cast<int>(place.z));
        sums.values[at] += luminance(glm::dvec3(colour));
        sums.counts[at] += 1;
    }
}

}  // namespace

Result<BakedLight> BakedLight::measured(const octree::NodeSource& source) {
    BakedLight baked;
    const auto [low, high] = octree::robust_bounds(source);
    const glm::dvec3 sides = high - low;
    baked.min_ = low;
    baked.cell_ = std::max({sides.x, sides.y, sides.z, 1e-9}) / kCells;
    baked.size_ = glm::clamp(glm::ivec3(glm::ceil(sides / baked.cell_)), 1, kCells);
    Sums sums(baked.size_);
    std::vector<uint32_t> level = source.roots(), below;
    size_t nodes = 0;
    for (uint64_t points = 0; !level.empty() && points < kSampled; level.swap(below)) {
        below.clear();
        for (const uint32_t node : level) {
            if (++nodes > kMostNodes) break;
            LUCARNE_ASSIGN(const octree::NodeData data, source.load(node));
            points += data.count;
            add_node(source, node, data, baked.min_, baked.cell_, sums);
            for (uint32_t octant = 0; octant < 8; ++octant)
                if (const uint32_t child = source.nodes()[node].child(octant); child != octree::kNoNode)
                    below.push_back(child);
        }
    }
    double value = 0, count = 0;
    for (size_t i = 0; i < sums.values.size(); ++i) value += sums.values[i], count += sums.counts[i];
    baked.mean_ = count > 0 ? value / count : 0;
    for (int axis = 0; axis < 3; ++axis) sums = blurred(sums, axis);
    std::vector<float> means(sums.values.size());
    for (size_t i = 0; i < means.size(); ++i)
        if (sums.counts[i] > 0) means[i] = static_cast<float>(sums.values[i] / sums.counts[i]);
    baked.means_ = std::make_shared<const std::vector<float>>(std::move(means));
    return baked;
}

BakedLight BakedLight::in_unit(double scale) const {
    BakedLight own = *this;
    own.min_ /= scale;
    own.cell_ /= scale;
    return own;
}

/// Interpolates trilinearly between the middles of cells that have points.
double BakedLight::mean_at(const glm::dvec3& position) const {
    const glm::dvec3 place = within((position - min_) / cell_ - 0.5, size_);
    const glm::ivec3 low = glm::ivec3(place);
    const glm::dvec3 share = place - glm::dvec3(low);
    double sum = 0, weights = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        glm::ivec3 at = low;
        for (int axis = 0; axis < 3; ++axis) {
            const bool upper = corner >> axis & 1;
            weight *= upper ? share[axis] : 1 - share[axis];
            if (upper) at[axis] = std::min(at[axis] + 1, size_[axis] - 1);
        }
        const float mean = (*means_)[static_cast<size_t>((at.z * size_.y + at.y) * size_.x + at.x)];
        if (!(mean > 0)) continue;
        sum += weight * static_cast<double>(mean);
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

double BakedLight::factor(const glm::dvec3& position, double share) const {
    const double here = mean_ > 0 ? mean_at(position) : 0;
    if (!(here > 0)) return 1;
    return std::pow(std::clamp(mean_ / here, 1 / kMost, kMost), share);
}

}  // namespace lucarne::gi
