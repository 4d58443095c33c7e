#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "octree/stations/scan_runs.h"

namespace lucarne::octree {

/// The vertical plane through the points of a run, seen from above. Metres, relative to ScanRuns::origin().
struct ScanLine {
    uint32_t run = 0;
    glm::dvec2 centre{0.0}, along{1, 0};  ///< mean of the points; unit vector
    double error = 0;                     ///< deviation across the line, as a share of that along it

    glm::dvec2 across() const { return {-along.y, along.x}; }
};

/// Returns the runs whose points lie in one vertical plane, and far enough apart to tell its direction.
std::vector<ScanLine> scan_lines(const ScanRuns& runs, double metres_per_unit);

/// Whether a line passes a place on the ground (m, relative to ScanRuns::origin()), as exactly as its points
/// tell its direction.
bool passes(const ScanLine& line, const glm::dvec2& place);

/// Returns which of `count` equal sectors of a half circle has the line's direction.
size_t direction_of(const ScanLine& line, size_t count);

/// A place through which many lines pass.
struct Meeting {
    glm::dvec2 place{0.0};
    std::vector<uint32_t> lines;  ///< indices of the lines that pass it
};

/// Finds one place after another at which lines cross (a Hough transform over pairs of lines), those that
/// most pairs name first.
class LineMeetings {
 public:
    /// `lines` outlives this object.
    explicit LineMeetings(const std::vector<ScanLine>& lines);

    /// Returns the place that most pairs of lines name which are not taken, each place once. Empty: there is
    /// none any more.
    std::optional<Meeting> next();
    /// Takes the lines of a meeting out of the search.
    void take(const Meeting& meeting);

 private:
    struct Crossing {
        int32_t x, y;  ///< cell
        uint32_t first, second;
        bool visited = false;
    };
    bool counts(const Crossing& crossing) const {
        return !crossing.visited && !taken_[crossing.first] && !taken_[crossing.second];
    }
    Meeting refined(const glm::dvec2& start) const;

    const std::vector<ScanLine>& lines_;
    std::vector<bool> taken_;
    std::vector<Crossing> crossings_;  ///< sorted by cell
};

}  // namespace lucarne::octree
