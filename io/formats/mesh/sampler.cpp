#include "io/formats/mesh/sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::io::mesh {
namespace {

constexpr double kCandidates = 8;            ///< per square of the spacing
constexpr int kBlock = 48, kLeastBlock = 4;  ///< in cells
constexpr int kHalo = 2, kMostHalo = 7;
constexpr size_t kBlocksAtOnce = 32;
/// A block with more candidates is split.
constexpr size_t kMostCandidates = size_t{1} << 18;
/// Only the first so many candidates in a cell count; otherwise many layers of surface would fill the memory.
/// A plane gives up to 50.
constexpr uint8_t kMostInCell = 200;
/// For so few candidates, comparing all pairs is faster than clearing the cells of a block: a sliver may
/// cross thousands of cells.
constexpr size_t kFew = 64;
/// Surfaces whose normals differ by more than this angle do not affect each other: a thin wall gets samples
/// on both sides.
constexpr float kSameSide = -0.5f;
constexpr uint64_t kSeed = 0x6d657368;

bool overlap(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& box_low,
             const glm::dvec3& box_high) {
    return low.x <= box_high.x && low.y <= box_high.y && low.z <= box_high.z && high.x >= box_low.x &&
           high.y >= box_low.y && high.z >= box_low.z;
}
bool inside(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& box_low,
            const glm::dvec3& box_high) {
    return low.x >= box_low.x && low.y >= box_low.y && low.z >= box_low.z && high.x <= box_high.x &&
           high.y <= box_high.y && high.z <= box_high.z;
}
using Points = std::array<glm::dvec3, 3>;
glm::dvec3 low_of(const Points& p) {
    return glm::min(p[0], glm::min(p[1], p[2]));
}
glm::dvec3 high_of(const Points& p) {
    return glm::max(p[0], glm::max(p[1], p[2]));
}

/// Returns the corner opposite the longest of three edges. `a` is the squared length of the edge opposite
/// corner 0.
size_t widest(double a, double b, double c) {
    return a >= b && a >= c ? 0 : b >= c ? 1 : 2;
}

/// Returns whether a triangle overlaps a box, or misses it by no more than rounding errors. They do not
/// overlap if an axis separates them: an axis of the box, the normal, or a cross product of an edge of each
/// (Akenine-Moeller 2001, "Fast 3D triangle-box overlap testing").
bool touches(const Points& p, const glm::dvec3& low, const glm::dvec3& high) {
    if (!overlap(low_of(p), high_of(p), low, high)) return false;
    const glm::dvec3 middle = (low + high) * 0.5, half = (high - low) * 0.5;
    const Points q = {p[0] - middle, p[1] - middle, p[2] - middle};
    const double far = glm::length(q[0]) + glm::length(q[1]) + glm::length(q[2]);
    // `factors` is the product of the lengths that the axis was computed from. A sliver's normal is short
    // compared to them, and rounding changes its direction.
    const auto parts = [&](const glm::dvec3& axis, double factors) {
        const double a = glm::dot(axis, q[0]), b = glm::dot(axis, q[1]), c = glm::dot(axis, q[2]);
        const double reach = glm::dot(glm::abs(axis), half);
        const double rounded = 1e-14 * factors * far;
        return std::min({a, b, c}) > reach + rounded || std::max({a, b, c}) < -reach - rounded;
    };
    const Points edges = {q[1] - q[0], q[2] - q[1], q[0] - q[2]};
    if (parts(glm::cross(edges[0], edges[1]), glm::length(edges[0]) * glm::length(edges[1]))) return false;
    return std::ranges::none_of(edges, [&](const glm::dvec3& e) {
        const double length = glm::length(e);
        return parts({0, -e.z, e.y}, length) || parts({e.z, 0, -e.x}, length) ||
               parts({-e.y, e.x, 0}, length);
    });
}

/// Sorts numbers that are spread evenly over 64 bits, by distributing them to as many buckets first.
void spread_sort(std::vector<uint64_t>& numbers) {
    const int bits = std::bit_width(numbers.size() / 2);
    if (bits == 0) return std::sort(numbers.begin(), numbers.end());
    std::vector<uint32_t> end((size_t{1} << bits) + 1);
    for (const uint64_t n : numbers) ++end[(n >> (64 - bits)) + 1];
    for (size_t i = 1; i < end.size(); ++i) end[i] += end[i - 1];
    std::vector<uint64_t> sorted(numbers.size());
    for (const uint64_t n : numbers) sorted[end[n >> (64 - bits)]++] = n;
    for (size_t i = 0, begin = 0; i + 1 < end.size(); begin = end[i++])
        std::sort(&sorted[0] + begin, &sorted[0] + end[i]);
    numbers = std::move(sorted);
}

}  // namespace

/// A block with the cells around it, whose candidates are examined.
struct Sampler::Region {
    glm::ivec3 low, high, size;
    glm::bvec3 open_low, open_high;  ///< whether the mesh continues on that side
    glm::dvec3 box_low, box_high;
    uint32_t cell(const glm::ivec3& at) const {
        return static_cast<uint32_t>((at.z * size.y + at.y) * size.x + at.x);
    }
    size_t cells() const {
        return static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z);
    }
};

struct Sampler::Candidates {
    struct One {
        glm::dvec3 at;
        glm::vec2 share;
        uint32_t face, cell;
    };
    static constexpr uint64_t kIndex = (uint64_t{1} << 24) - 1;
    std::vector<One> list;
    std::vector<uint64_t> order;     ///< of each: the upper 40 bits of its hash, and its index
    std::vector<glm::vec3> normals;  ///< one per triangle of the block

    /// Sorts by order and drops the candidates that are too many for their cell.
    void sort(const Region& region) {
        spread_sort(order);
        if (order.size() <= kMostInCell) return;
        std::vector<uint8_t> seen(region.cells());
        std::erase_if(order, [&](uint64_t o) {
            uint8_t& count = seen[list[o & kIndex].cell];
            if (count == kMostInCell) return true;
            ++count;
            return false;
        });
    }
    /// Removes the candidates that `sort` dropped.
    void shrink() {
        std::vector<One> kept;
        for (uint64_t& o : order) {
            kept.push_back(list[o & kIndex]);
            o = (o & ~kIndex) | (kept.size() - 1);
        }
        list = std::move(kept);
    }
};

/// A triangle that is being cut. Positions are linear in the weights of the second and third corner.
struct Sampler::Face {
    glm::dvec3 corner, u, v;
    double uu, uv, vv;          ///< products of u and v, to get lengths from weights
    uint32_t triangle, number;  ///< in the mesh, in the block
    glm::dvec3 at(const glm::dvec2& share) const { return corner + u * share.x + v * share.y; }
    double squared(const glm::dvec2& share) const {
        return share.x * share.x * uu + 2 * share.x * share.y * uv + share.y * share.y * vv;
    }
};

/// A part of a triangle. The candidates of the whole mesh are numbered consecutively; this part has the
/// numbers from `begin` to `end`.
struct Sampler::Piece {
    std::array<glm::dvec2, 3> shares;
    double begin, end;
    uint64_t path;
    bool inside;
};

Sampler::Sampler(const Mesh& mesh, double spacing)
    : mesh_(mesh),
      radius_(spacing * kNearest),
      cell_(2 * radius_),
      density_(kCandidates / (spacing * spacing)),
      origin_(mesh.low) {
    if (mesh.triangles.empty()) return;
    cells_ = glm::ivec3((mesh.high - mesh.low) / cell_) + 1;
    Block all{glm::ivec3(0), cells_, std::vector<uint32_t>(mesh.triangles.size())};
    for (uint32_t i = 0; i < all.triangles.size(); ++i) all.triangles[i] = i;
    stack_.push_back(std::move(all));
}

bool Sampler::next(std::vector<Sample>& samples) {
    samples.clear();
    while (samples.empty() && !stack_.empty()) {
        std::vector<Block> blocks;
        while (blocks.size() < kBlocksAtOnce && !stack_.empty()) {
            Block block = std::move(stack_.back());
            stack_.pop_back();
            const glm::ivec3 size = block.high - block.low;
            if (std::max({size.x, size.y, size.z}) <= kBlock)
                blocks.push_back(std::move(block));
            else
                split(std::move(block), stack_);
        }
        std::vector<std::vector<Sample>> found(blocks.size());
        parallel_ranges(blocks.size(), 1, [&](size_t i, size_t) { sample(std::move(blocks[i]), found[i]); });
        for (const auto& some : found) samples.insert(samples.end(), some.begin(), some.end());
    }
    return !samples.empty();
}

/// Halves a block along every axis longer than half of the longest, at multiples of the block size while it
/// is larger.
void Sampler::split(Block block, std::vector<Block>& children) const {
    const glm::ivec3 size = block.high - block.low;
    const int longest = std::max({size.x, size.y, size.z});
    std::vector<Block> made{{block.low, block.high, {}}};
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] * 2 <= longest) continue;
        for (size_t i = 0, count = made.size(); i < count; ++i) {
            Block upper{made[i].low, made[i].high, {}};
            const int half =
                size[axis] > kBlock ? (size[axis] + kBlock) / (2 * kBlock) * kBlock : size[axis] / 2;
            upper.low[axis] = made[i].high[axis] = block.low[axis] + half;
            made.push_back(std::move(upper));
        }
    }
    for (Block& child : made) {
        const Region region = region_of(child, kMostHalo);
        for (const uint32_t triangle : block.triangles)
            if (touches(mesh_.points(triangle), region.box_low, region.box_high))
                child.triangles.push_back(triangle);
        if (!child.triangles.empty()) children.push_back(std::move(child));
    }
}

Sampler::Region Sampler::region_of(const Block& block, int halo) const {
    Region region;
    region.low = glm::max(block.low - halo, glm::ivec3(0));
    region.high = glm::min(block.high + halo, cells_);
    region.size = region.high - region.low;
    region.open_low = glm::greaterThan(region.low, glm::ivec3(0));
    region.open_high = glm::lessThan(region.high, cells_);
    // A little more, because of rounding.
    region.box_low = origin_ + (glm::dvec3(region.low) - 0.01) * cell_;
    region.box_high = origin_ + (glm::dvec3(region.high) + 0.01) * cell_;
    return region;
}

void Sampler::sample(Block block, std::vector<Sample>& samples) const {
    Candidates candidates;
    for (int halo = kHalo;; halo = kMostHalo) {
        const Region region = region_of(block, halo);
        const glm::ivec3 size = block.high - block.low;
        const bool may_split = std::max({size.x, size.y, size.z}) > kLeastBlock;
        if (!gather(region, block, may_split, candidates)) {
            std::vector<Block> children;
            split(std::move(block), children);
            for (Block& child : children) sample(std::move(child), samples);
            return;
        }
        const size_t before = samples.size();
        if (choose(region, block, halo < kMostHalo, candidates, samples)) return;
        samples.resize(before);
    }
}

/// Collects the candidates of a region, in their order. Returns false if they are too many and the block can
/// be split.
bool Sampler::gather(const Region& region, const Block& block, bool may_fail, Candidates& found) const {
    found = {};
    size_t room = kMostCandidates;
    for (const uint32_t triangle : block.triangles) {
        const auto number = static_cast<uint32_t>(found.normals.size());
        found.normals.emplace_back(0.0f);
        const double begin = mesh_.area_before[triangle] * density_ + 0.5;
        const double end = mesh_.area_before[triangle + 1] * density_ + 0.5;
        if (std::floor(begin) == std::floor(end)) continue;
        const auto [a, b, c] = mesh_.points(triangle);
        const Face face{
            a,        b - a, c - a, glm::dot(b - a, b - a), glm::dot(b - a, c - a), glm::dot(c - a, c - a),
            triangle, number};
        found.normals.back() = glm::normalize(glm::cross(face.u, face.v));
        cut(region, face, {{{{0, 0}, {1, 0}, {0, 1}}}, begin, end, 1, false}, found);
        if (found.list.size() <= room) continue;
        if (may_fail) return false;
        found.sort(region);
        found.shrink();
        room = std::max(room, 2 * found.list.size());
    }
    found.sort(region);
    return true;
}

void Sampler::cut(const Region& region, const Face& face, const Piece& piece, Candidates& found) const {
    if (std::floor(piece.begin) == std::floor(piece.end)) return;
    const auto& s = piece.shares;
    bool within = piece.inside;
    if (!within) {
        const Points points = {face.at(s[0]), face.at(s[1]), face.at(s[2])};
        const glm::dvec3 low = low_of(points), high = high_of(points);
        if (!overlap(low, high, region.box_low, region.box_high)) return;
        within = inside(low, high, region.box_low, region.box_high);
    }
    if (piece.end - piece.begin > 1) {
        const size_t tip =
            widest(face.squared(s[2] - s[1]), face.squared(s[0] - s[2]), face.squared(s[1] - s[0]));
        const glm::dvec2 &next = s[(tip + 1) % 3], &last = s[(tip + 2) % 3], middle = (next + last) * 0.5;
        const double half = piece.begin + (piece.end - piece.begin) * 0.5;
        cut(region, face, {{s[tip], next, middle}, piece.begin, half, piece.path * 2, within}, found);
        cut(region, face, {{s[tip], middle, last}, half, piece.end, piece.path * 2 + 1, within}, found);
        return;
    }
    const uint64_t random = mix64(mix64(kSeed, face.triangle), piece.path);
    double u = static_cast<double>(random >> 32) * 0x1p-32;
    double v = static_cast<double>(random & 0xffffffffu) * 0x1p-32;
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const glm::dvec2 share = s[0] * (1 - u - v) + s[1] * u + s[2] * v;
    const glm::dvec3 at = face.at(share);
    const glm::ivec3 cell = glm::clamp(glm::ivec3((at - origin_) / cell_), glm::ivec3(0), cells_ - 1);
    if (glm::any(glm::lessThan(cell, region.low)) || glm::any(glm::greaterThanEqual(cell, region.high)))
        return;
    found.order.push_back((mix64(random) & ~Candidates::kIndex) | found.list.size());
    found.list.push_back({at, glm::vec2(share), face.number, region.cell(cell - region.low)});
}

/// Adds the candidates of the block that are kept. Returns false if `surely` is set and some candidates
/// depend on what lies beyond the region.
bool Sampler::choose(const Region& region, const Block& block, bool surely, const Candidates& candidates,
                     std::vector<Sample>& samples) const {
    struct Kept {
        glm::dvec3 at;
        glm::vec3 normal;
        uint32_t next;  ///< next in the same cell, counted from 1
        bool unsure;
    };
    const bool few = candidates.order.size() <= kFew;       // then all are in one list
    std::vector<uint32_t> first(few ? 1 : region.cells());  // 0 means none
    std::vector<Kept> kept;
    kept.reserve(candidates.order.size() / 8);
    const double near = radius_ * radius_;
    for (const uint64_t order : candidates.order) {
        const auto& candidate = candidates.list[order & Candidates::kIndex];
        const glm::vec3 normal = candidates.normals[candidate.face];
        const auto number = static_cast<int>(candidate.cell);
        const glm::ivec3 at(number % region.size.x, number / region.size.x % region.size.y,
                            number / region.size.x / region.size.y);
        bool unsure = false;
        /// Returns whether a kept candidate in this cell excludes this one.
        const auto taken = [&](uint32_t cell) {
            for (uint32_t entry = first[few ? 0 : cell]; entry != 0; entry = kept[entry - 1].next) {
                const Kept& other = kept[entry - 1];
                const glm::dvec3 apart = other.at - candidate.at;
                if (glm::dot(apart, apart) >= near || glm::dot(other.normal, normal) < kSameSide) continue;
                if (!other.unsure) return true;
                unsure = true;
            }
            return false;
        };
        if (taken(candidate.cell)) continue;
        // Along each axis the disc reaches only into the nearer neighbour.
        const glm::dvec3 in_cell = (candidate.at - origin_) / cell_ - glm::dvec3(at + region.low);
        const glm::ivec3 side = at + glm::ivec3(glm::greaterThanEqual(in_cell, glm::dvec3(0.5))) * 2 - 1;
        bool out = false;
        for (int k = 1; k < 8 && !out; ++k) {
            const glm::ivec3 cell((k & 1) != 0 ? side.x : at.x, (k & 2) != 0 ? side.y : at.y,
                                  (k & 4) != 0 ? side.z : at.z);
            if (glm::any(glm::lessThan(cell, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(cell, region.size)))
                // What is kept beyond the region is unknown if the mesh continues there.
                unsure = unsure || glm::any(region.open_low && glm::lessThan(cell, glm::ivec3(0))) ||
                         glm::any(region.open_high && glm::greaterThanEqual(cell, region.size));
            else
                out = taken(region.cell(cell));
        }
        if (out) continue;
        unsure = unsure && surely;
        uint32_t& newest = first[few ? 0 : candidate.cell];
        kept.push_back({candidate.at, normal, newest, unsure});
        newest = static_cast<uint32_t>(kept.size());
        const glm::ivec3 whole = at + region.low;
        if (glm::any(glm::lessThan(whole, block.low)) || glm::any(glm::greaterThanEqual(whole, block.high)))
            continue;
        if (unsure) return false;
        samples.push_back({candidate.at, candidate.share, block.triangles[candidate.face]});
    }
    return true;
}

}  // namespace lucarne::io::mesh
