#include "octree/convert/scans/early_count.h"

#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

namespace lucarne::octree {
namespace {

/// Returns the position of the record nearest to a stated corner. A header may round a coordinate in another
/// way than the records do. Empty if no record can be there.
std::optional<glm::dvec3> as_read(const io::Schema& schema, const glm::dvec3& corner) {
    if (schema.position == io::PositionType::f64) return corner;
    std::array<std::byte, io::position_bytes(io::PositionType::f64)>
        record{};  // compilers see no shorter one
    for (int axis = 0; axis < 3; ++axis) {
        std::byte* at = &record[4 * static_cast<size_t>(axis)];
        if (schema.position == io::PositionType::f32) {
            if (!(std::abs(corner[axis]) <= std::numeric_limits<float>::max())) return std::nullopt;
            io::store(at, static_cast<float>(corner[axis]));
            continue;
        }
        using Limits = std::numeric_limits<int32_t>;
        const double integer = std::round((corner[axis] - schema.offset[axis]) / schema.scale[axis]);
        if (!(integer >= Limits::min() && integer <= Limits::max())) return std::nullopt;
        io::store(at, static_cast<int32_t>(integer));
    }
    return io::position_of(schema, record.data());
}

/// The bounds and the number of all points, as the inputs' headers state them.
struct Stated {
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-min};
    uint64_t points = 0;
};
std::optional<Stated> stated_by(const Unifier& inputs) {
    Stated all;
    for (size_t input = 0; input < inputs.inputs(); ++input) {
        const io::ScanInfo& info = inputs.source(input).info();
        if (info.declared_points == 0) continue;
        if (!info.stated_box) return std::nullopt;
        const io::Schema& schema = inputs.source(input).schema();
        const auto low = as_read(schema, info.stated_box->front()),
                   high = as_read(schema, info.stated_box->back());
        if (!low || !high) return std::nullopt;
        all.min = glm::min(all.min, *low);
        all.max = glm::max(all.max, *high);
        const uint64_t room = std::numeric_limits<uint64_t>::max() - all.points;
        all.points += std::min(info.declared_points, room);
    }
    return all;
}

}  // namespace

EarlyCount::EarlyCount(const Unifier& inputs, uint64_t grid_bytes) : grid_bytes_(grid_bytes) {
    const auto stated = stated_by(inputs);
    if (!stated || !glm::all(glm::lessThanEqual(stated->min, stated->max))) return;
    const auto cube = root_cube(stated->min, stated->max);
    if (!cube) return;
    cube_ = *cube;
    grid_.emplace(NodeKey{}, stated->points, grid_bytes_);
}

void EarlyCount::add(const io::Schema& schema, std::span<const std::byte> records, const glm::dvec3& min,
                     const glm::dvec3& max) {
    if (!grid_) return;
    if (!glm::all(glm::greaterThanEqual(min, cube_.min)) ||
        !glm::all(glm::lessThanEqual(max, cube_.min + cube_.size))) {
        grid_.reset();
        return;
    }
    for (size_t at = 0; at < records.size(); at += schema.stride)
        grid_->count(cube_.place(io::position_of(schema, &records[at])));
}

std::optional<CountGrid> EarlyCount::take(const ScanFacts& facts) {
    std::optional<CountGrid> grid = std::move(grid_);
    grid_.reset();
    const bool usable = grid && cube_.min == facts.root.min && cube_.size == facts.root.size &&
                        grid->coarsen_for(facts.points, grid_bytes_);
    return usable ? std::move(grid) : std::nullopt;
}

}  // namespace lucarne::octree
