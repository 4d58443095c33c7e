#include "gi/surfels/outliers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/surfel_code.h"
#include "octree/tree/footprint.h"

namespace lucarne::gi {
namespace {

constexpr size_t kLeastNeighbours = 16, kMostNeighbours = 64;
constexpr uint32_t kOctave = 8;        // area codes in an octave (surfel.h)
constexpr float kInPlane = 0.25f;      // height over the plane of a disc, of the distance
constexpr float kLeastInPlane = 0.7f;  // share of the neighbours
constexpr float kFilled = 0.75f;       // share of a disc that smaller ones must cover
constexpr float kLeastBare = 0.3f;     // share of the neighbours without a normal, for leaves and wires

uint32_t area_code(const PackedSurfel& s) {
    return s.b >> 16 & 255u;
}
bool has_normal(const PackedSurfel& s) {
    return (s.d & kSurfelHasNormal) != 0u;
}
void set_area_code(PackedSurfel& s, uint32_t code) {
    s.b = (s.b & 0xff00ffffu) | code << 16;
}
bool has_share(const PackedSurfel& s) {
    return area_code(s) != kUnknownArea && !surfel_is_stray(s.b, s.d);
}
/// Returns the disc's radius in sides of the node's cube, at full resolution.
float radius(const PackedSurfel& s) {
    return octree::surfel_radius(surfel_own_area(s.b, 1.0f), 0.0f);
}

/// The surfels of a node by the cells of a grid of 2^bits cells a side.
class Grid {
 public:
    Grid(std::span<const PackedSurfel> surfels, uint32_t bits) : bits_(bits), first_(cells() + 1) {
        std::vector<uint32_t> cell(surfels.size());
        for (size_t i = 0; i < surfels.size(); ++i) {
            if (!has_share(surfels[i])) continue;
            cell[i] = index(place(surfels[i]));
            ++first_[cell[i] + 1];
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        sorted_.resize(first_.back());
        std::vector<uint32_t> next = first_;
        for (size_t i = 0; i < surfels.size(); ++i)
            if (has_share(surfels[i])) sorted_[next[cell[i]]++] = static_cast<uint32_t>(i);
    }
    float cell_size() const { return 1.0f / static_cast<float>(1u << bits_); }
    glm::uvec3 place(const PackedSurfel& s) const {
        return glm::uvec3(s.a & 0xffffu, s.a >> 16, s.b & 0xffffu) >> (16u - bits_);
    }
    /// Sets `result` to the surfels of the cell and its 26 neighbours; of more than kMostNeighbours to each
    /// n-th of them. Returns n.
    uint32_t around(const glm::uvec3& place, std::vector<uint32_t>& result) const {
        const glm::uvec3 low = glm::max(place, 1u) - 1u, high = glm::min(place + 1u, (1u << bits_) - 1);
        const auto each_row = [&](const auto& visit) {
            for (uint32_t z = low.z; z <= high.z; ++z)
                for (uint32_t y = low.y; y <= high.y; ++y)
                    visit(first_[index({low.x, y, z})], first_[index({high.x, y, z}) + 1]);
        };
        size_t count = 0;
        each_row([&](uint32_t from, uint32_t to) { count += to - from; });
        const auto step =
            static_cast<uint32_t>(std::max<size_t>((count + kMostNeighbours - 1) / kMostNeighbours, 1));
        result.clear();
        size_t skip = 0;
        each_row([&](uint32_t from, uint32_t to) {
            size_t i = from + skip;
            for (; i < to; i += step) result.push_back(sorted_[i]);
            skip = i - to;
        });
        return step;
    }

 private:
    size_t cells() const { return size_t{1} << (3 * bits_); }
    uint32_t index(const glm::uvec3& p) const { return (p.z << bits_ | p.y) << bits_ | p.x; }

    uint32_t bits_;
    std::vector<uint32_t> first_, sorted_;
};

/// Compares surfels with their neighbours.
class Judge {
 public:
    explicit Judge(std::span<const PackedSurfel> surfels)
        : surfels_(surfels), grids_{Grid(surfels, 5), Grid(surfels, 4), Grid(surfels, 3), Grid(surfels, 2)} {}

    bool is_outlier(size_t i, uint32_t strictness) {
        const PackedSurfel& surfel = surfels_[i];
        const uint32_t step = find_neighbours(i);
        if (around_.size() < kLeastNeighbours) return !has_normal(surfel);
        const uint32_t usual = median_code(), own = area_code(surfel);
        const auto larger = [&](uint32_t octaves) { return own + octaves * kOctave < usual; };
        if (!has_normal(surfel)) return larger(1) || share_without_normal() < kLeastBare;
        if (!larger(2)) return false;
        return strictness >= 3 || share_in_plane(surfel) < kLeastInPlane || cover(surfel, step) > kFilled;
    }

 private:
    /// Finds neighbours by the finest grid whose cells are not smaller than the disc and that has enough.
    uint32_t find_neighbours(size_t i) {
        const float r = radius(surfels_[i]);
        uint32_t step = 1;
        for (const Grid& grid : grids_) {
            if (grid.cell_size() < r && &grid != &grids_.back()) continue;
            step = grid.around(grid.place(surfels_[i]), around_);
            std::erase(around_, static_cast<uint32_t>(i));
            if (around_.size() >= kLeastNeighbours) break;
        }
        return step;
    }
    float share_without_normal() const {
        const auto bare =
            std::ranges::count_if(around_, [&](uint32_t j) { return !has_normal(surfels_[j]); });
        return static_cast<float>(bare) / static_cast<float>(around_.size());
    }
    uint32_t median_code() {
        codes_.clear();
        for (const uint32_t j : around_) codes_.push_back(area_code(surfels_[j]));
        const auto middle = codes_.begin() + static_cast<ptrdiff_t>(codes_.size() / 2);
        std::nth_element(codes_.begin(), middle, codes_.end());
        return *middle;
    }
    glm::vec3 toward(const PackedSurfel& from, uint32_t j) const {
        return surfel_fractions(surfels_[j].a, surfels_[j].b) - surfel_fractions(from.a, from.b);
    }
    /// Returns the share of the neighbours that lie in the plane of a disc.
    float share_in_plane(const PackedSurfel& disc) const {
        const glm::vec3 normal = decode_octahedral(disc.c);
        float count = 0;
        for (const uint32_t j : around_) {
            const glm::vec3 offset = toward(disc, j);
            count += std::abs(glm::dot(offset, normal)) <= kInPlane * glm::length(offset) ? 1.0f : 0.0f;
        }
        return count / static_cast<float>(around_.size());
    }
    /// Returns which share of a disc smaller ones within its radius would fill.
    float cover(const PackedSurfel& disc, uint32_t step) const {
        const float r = radius(disc);
        float sum = 0;
        for (const uint32_t j : around_)
            if (area_code(surfels_[j]) > area_code(disc) + 2 * kOctave && glm::length(toward(disc, j)) < r)
                sum += surfel_own_area(surfels_[j].b, 1.0f);
        return sum * static_cast<float>(step) / (static_cast<float>(M_PI) * r * r);
    }

    std::span<const PackedSurfel> surfels_;
    std::array<Grid, 4> grids_;
    std::vector<uint32_t> around_, codes_;
};

/// Returns the median area code; that of an unknown share if no surfel has one.
uint32_t median_code(std::span<const PackedSurfel> surfels) {
    std::vector<uint32_t> codes;
    for (const PackedSurfel& s : surfels)
        if (has_share(s)) codes.push_back(area_code(s));
    if (codes.empty()) return kUnknownArea;
    const auto middle = codes.begin() + static_cast<ptrdiff_t>(codes.size() / 2);
    std::nth_element(codes.begin(), middle, codes.end());
    return *middle;
}

void hide(PackedSurfel& surfel) {
    set_area_code(surfel, kStrayArea);
    surfel.c = 0;
    surfel.d &= ~(kSurfelHasNormal | kSurfelHasEdge);
}

}  // namespace

void choose_outliers(uint32_t strictness, const std::vector<uint32_t>& found,
                     std::vector<PackedSurfel>& surfels) {
    if (strictness == kFoundOutliers || surfels.empty()) return;
    if (strictness == kDrawOutliers) {
        const uint32_t usual = found.empty() ? kUnknownArea : median_code(surfels);
        for (const uint32_t i : found) set_area_code(surfels[i], usual);
        return;
    }
    const auto normals = static_cast<size_t>(std::ranges::count_if(surfels, has_normal));
    if (2 * normals < surfels.size()) return;  // normals say nothing here: none were computed
    Judge judge(surfels);
    std::vector<uint32_t> hidden;
    for (size_t i = 0; i < surfels.size(); ++i) {
        const bool bare = !has_normal(surfels[i]);
        if (!bare && !has_share(surfels[i])) continue;
        if ((bare && strictness >= 3) || judge.is_outlier(i, strictness))
            hidden.push_back(static_cast<uint32_t>(i));
    }
    for (const uint32_t i : hidden) hide(surfels[i]);
}

}  // namespace lucarne::gi
