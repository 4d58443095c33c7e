#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi {

/// Returns the axis along which a vector is longest: 0, 1 or 2.
inline int largest_axis(const glm::vec3& v) {
    const glm::vec3 size = glm::abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// A grid of points in a rectangle across an axis of the coordinates, and which of them discs cover.
class Coverage {
 public:
    /// `w`: the axis; the points lie in the plane through `origin` with the given normal, whose w is not 0.
    Coverage(int w, const glm::vec3& low, const glm::vec3& high, const glm::vec3& origin,
             const glm::vec3& normal)
        : w_(w), u_((w + 1) % 3), v_((w + 2) % 3), low_(low), origin_(origin), normal_(normal) {
        cell_ = (high - low) / static_cast<float>(kSide);
    }
    glm::vec3 point(int i, int j) const {
        glm::vec3 p;
        p[u_] = low_[u_] + cell_[u_] * (static_cast<float>(i) + 0.5f);
        p[v_] = low_[v_] + cell_[v_] * (static_cast<float>(j) + 0.5f);
        p[w_] = origin_[w_] -
                ((p[u_] - origin_[u_]) * normal_[u_] + (p[v_] - origin_[v_]) * normal_[v_]) / normal_[w_];
        return p;
    }
    /// Adds the points that a disc hides from whoever looks along `normal`, or along the axis if the disc
    /// has its own `normal`. `edge`: the line at which the disc ends (gi/shared/edge.h).
    void add(const glm::vec3& middle, float radius, const glm::vec3& normal, const glm::vec3& edge) {
        const Range columns = range(u_, middle, radius), rows = range(v_, middle, radius);
        // Numbers of their own instead of vectors that are indexed: those would be in memory, not in
        // registers.
        const float normal_u = normal[u_], normal_v = normal[v_], normal_w = normal[w_];
        const float low_u = low_[u_], low_v = low_[v_], cell_u = cell_[u_], cell_v = cell_[v_];
        const float middle_u = middle[u_], middle_v = middle[v_];
        const float edge_u = edge[u_], edge_v = edge[v_], edge_w = edge[w_];
        for (int j = rows.first; j < rows.last; ++j) {
            const float v = low_v + cell_v * (static_cast<float>(j) + 0.5f) - middle_v;
            for (int i = columns.first; i < columns.last; ++i) {
                const float u = low_u + cell_u * (static_cast<float>(i) + 0.5f) - middle_u;
                const float w = -(u * normal_u + v * normal_v) / normal_w;
                if (u * u + v * v + w * w <= radius * radius && u * edge_u + v * edge_v + w * edge_w <= 1)
                    covered_ |= uint64_t{1} << (kSide * j + i);
            }
        }
    }
    /// The covered points: bit 8 j + i is the point i along the axis after w, and j along the one after that.
    uint64_t covered() const { return covered_; }
    /// Returns covered() and the points that have at least three covered neighbours out of four: uneven discs
    /// leave gaps of one point in a surface without holes.
    uint64_t closed() const {
        constexpr uint64_t kFirstColumn = 0x0101010101010101u;
        const uint64_t a = covered_ << 1 & ~kFirstColumn, b = (covered_ & ~kFirstColumn) >> 1;
        const uint64_t c = covered_ << kSide, d = covered_ >> kSide;
        return covered_ | (a & b & (c | d)) | (c & d & (a | b));
    }
    /// Returns whether all points for which inside(point) is true are covered.
    template <class Inside>
    bool covers(const Inside& inside) const {
        for (uint64_t open = ~covered_; open != 0; open &= open - 1) {
            const int bit = std::countr_zero(open);
            if (inside(point(bit % kSide, bit / kSide))) return false;
        }
        return true;
    }
    /// Returns the share of those points for which inside(point) is true that are covered.
    template <class Inside>
    float share(const Inside& inside) const {
        int all = 0, hidden = 0;
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i)
                if (inside(point(i, j))) {
                    ++all;
                    hidden += (covered_ >> (kSide * j + i) & 1) != 0;
                }
        return all > 0 ? static_cast<float>(hidden) / static_cast<float>(all) : 1;
    }

 private:
    static constexpr int kSide = 8;
    struct Range {
        int first, last;
    };
    Range range(int axis, const glm::vec3& middle, float radius) const {
        if (!(cell_[axis] > 0)) return {0, kSide};
        const auto place = [&](float at) {
            return static_cast<int>(std::clamp((at - low_[axis]) / cell_[axis] + 0.5f, 0.0f, 1.0f * kSide));
        };
        return {place(middle[axis] - radius), place(middle[axis] + radius)};
    }

    int w_, u_, v_;
    glm::vec3 low_, origin_, normal_, cell_;
    uint64_t covered_ = 0;
};

}  // namespace lucarne::gi
