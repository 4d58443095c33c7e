#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/holes/planes.h"
#include "octree/holes/station_views.h"

namespace lucarne::octree {

/// What is known of one cell of a plane.
enum class PlaneCell : uint8_t {
    hidden,   ///< no point is here, and no station can have seen the place
    seen,     ///< no point is here, but a station saw a surface about here: points are sparse
    fringe,   ///< hidden, but covered by the disc of a point nearby
    surface,  ///< belongs to points of the plane
    bend,     ///< the plane's surface is here, but bends away from it
    crease,   ///< hidden; another plane of the scan ends here
    open,     ///< a station looked through
};

inline bool is_surface(PlaneCell state) {
    return state == PlaneCell::surface || state == PlaneCell::bend;
}

/// A plane of the scan as a grid of square cells.
class PlaneGrid {
 public:
    /// `cell`: edge of a cell, m.
    PlaneGrid(HolePlane plane, float cell);

    /// Returns how many cells the grid of a plane has, in doubles because planes may be of any size.
    static double cells_of(const HolePlane& plane, float cell);

    /// Enters a point, whose share of the surface reaches to `radius` around it and whose disc to `disc`, m.
    /// `as`: surface, or bend.
    void cover(const glm::vec3& position, float radius, float disc, PlaneCell as);
    /// Marks cells without points that a station looked through, or whose surroundings it saw.
    void look(const StationViews& views);

    const HolePlane& plane() const { return plane_; }
    float cell() const { return cell_; }
    int width() const { return width_; }
    int height() const { return height_; }
    size_t covered() const { return covered_; }  ///< number of cells with surface or bends
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
    size_t index(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
    }
    glm::ivec2 cell_at(size_t index) const {
        const auto width = static_cast<size_t>(width_);
        return {static_cast<int>(index % width), static_cast<int>(index / width)};
    }
    /// The cell of a place, which may be outside.
    glm::ivec2 cell_of(const glm::vec2& flat) const;
    /// A place in a cell; (.5, .5) is its middle. In the plane's axes.
    glm::vec2 flat_of(const glm::ivec2& cell, const glm::vec2& part = glm::vec2(0.5f)) const {
        return origin_ + cell_ * (glm::vec2(cell) + part);
    }
    glm::vec3 place_of(const glm::vec2& flat) const {
        return plane_.centre + flat.x * plane_.u + flat.y * plane_.v;
    }
    /// Whether a quarter of a cell (bit 0: upper half in x, bit 1: in y) contains a point.
    bool has_point(size_t index, int quarter) const { return quarters_[index] >> quarter & 1; }
    PlaneCell operator[](size_t index) const { return cells_[index]; }
    void set(size_t index, PlaneCell state) { cells_[index] = state; }

 private:
    HolePlane plane_;
    float cell_;
    glm::vec2 origin_{0.0f};
    int width_ = 0, height_ = 0;
    size_t covered_ = 0;
    std::vector<PlaneCell> cells_;
    std::vector<uint8_t> quarters_;  ///< of each cell: which have points
};

/// A line at which a plane ends because another plane of the scan crosses it.
struct CreasePlane {
    glm::vec3 normal{0.0f}, centre{0.0f};
};

/// Marks creases in a grid: hidden cells on the line where another plane crosses it, if that plane has points
/// within `reach` (m) above or below the line and is not open in between. Takes at most `work` steps and
/// returns how many it took.
uint64_t mark_creases(PlaneGrid& grid, const PlaneGrid& other, float reach, uint64_t work,
                      std::vector<CreasePlane>& creases);

}  // namespace lucarne::octree
