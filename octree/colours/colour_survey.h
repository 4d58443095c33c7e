#pragma once

#include <array>
#include <map>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/colours/gains.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/radix_sort.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

class CacheWriter;

/// Compares the colours of stations on nodes of an octree. Memory does not grow with the scan: at most
/// 1024 stations and 262 144 patches are kept.
class ColourSurvey {
 public:
    /// `header` outlives this object.
    explicit ColourSurvey(const SourceHeader& header);

    bool has_colours() const { return color_; }
    /// Adds the points of a node. The result depends on the order of the nodes, not on that of their points.
    void add(const Cube& cube, const NodeData& data);
    uint64_t points() const { return points_; }           ///< number added so far
    size_t stations() const { return stations_.size(); }  ///< number found so far

    /// Returns what was found, sorted by scan and station, without stations that have neither a gain nor
    /// unphotographed points.
    std::vector<StationColour> result() const;

 private:
    struct Station {
        StationKey key;
        uint64_t zeros = 0, coloured = 0;        ///< points with the colour 0,0,0; with another one
        std::array<uint64_t, 256> brightness{};  ///< coloured points by their largest component, of 255
        glm::dvec3 sum{0.0};                     ///< of their linear colours
        double white = 255;
    };
    struct Seen {  ///< a coloured point
        uint32_t record, station;
        glm::vec3 colour;  ///< linear
        bool clipped;
    };
    struct Patch {  ///< what one station saw in one cell
        uint32_t station = 0, points = 0;
        glm::vec3 colour{0.0f}, normal{0.0f};  ///< sums
        bool clipped = false;
    };
    size_t station_of(const StationKey& key);
    void see(const NodeData& data);
    void compare_cells(const Cube& cube, const NodeData& data);
    void compare_patches();
    void keep(const PatchRatio& ratio);
    static bool never_photographed(const Station& station);

    const SourceHeader& header_;
    const StationKeys keys_;
    const PointNormals normals_;
    bool has_normals_;
    const io::Attribute* color_ = nullptr;
    std::array<float, 256> linear_{};  ///< linear values of components, where white is 255
    uint64_t points_ = 0;
    std::vector<Station> stations_;
    std::map<StationKey, size_t> index_of_;
    std::vector<PatchRatio> ratios_;
    uint64_t offered_ = 0, step_ = 1;  ///< ratios found; each step_-th of them is kept
    // Used while a node is added:
    std::vector<Seen> seen_;
    std::vector<CodeIndex> sorted_;
    std::vector<Patch> patches_;
};

/// Surveys the colours of a cache that is about to be finished, on its coarsest nodes: an eighth of its
/// points, at least 65 536 and at most a million. `header` is the one that the cache will have.
Result<std::vector<StationColour>> survey_colours(CacheWriter& writer, const SourceHeader& header);

}  // namespace lucarne::octree
