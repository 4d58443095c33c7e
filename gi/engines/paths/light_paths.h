// Where light enters, and the ways that it can take from there: chosen without any knowledge of lights.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/groups.h"
#include "gi/engines/paths/sides.h"
#include "gi/engines/paths/surfaces.h"

namespace lucarne::gi::paths {

/// The entry points of Yue et al. 2007, section 5.1: places at which the light of lamps is computed. Each
/// stands for an equal part of its leaf's area, so that the areas of all add up to that of the surface.
struct EntryPoints {
    std::vector<Side> sides;       ///< of discs
    std::vector<uint32_t> places;  ///< of each: place_on()
    std::vector<uint32_t> first;   ///< of each leaf, and the end
    bool operator==(const EntryPoints&) const = default;
};
/// Returns the code of a place on a disc, by which it is off by less than 1e-4 radii.
uint32_t encode_place(const Surfel& disc, const glm::vec3& place);
/// Returns the place on a disc that has this code.
glm::vec3 place_on(const Surfel& disc, uint32_t code);

/// Chooses about `count` entry points, in proportion to area, but at least one in each leaf that `used`
/// names, and none in others. They are places that the rays of gathering points met, spread evenly over
/// these: what of a leaf a room sees may be darker than the rest, as in the reveal of a window, and of discs
/// that overlap it sees parts. Rays count by the area for which their point stands. In leaves that no ray met
/// they are centres of discs, spread by area.
class EntryChooser {
 public:
    /// `points`: with their rays, chosen with `seed`. `seen`: of each leaf, LampViews::seen(); more entry
    /// points, at most `count`, are where lamps would otherwise see few. Empty: it is not known where lamps
    /// will be. The references must outlive it.
    EntryChooser(const Surfaces& surfaces, const GroupBuilder& builder, std::span<const float> areas,
                 std::span<const uint8_t> used, const PointChooser::State& points, uint64_t seed,
                 uint64_t count, std::span<const float> seen);
    ~EntryChooser();
    /// Chooses those of some more leaves. Returns whether any are left.
    bool advance();
    EntryPoints take() { return std::move(entries_); }

 private:
    class MetPlaces;
    void add(Side side, const glm::vec3& place);

    const Surfaces& surfaces_;
    const GroupBuilder& builder_;
    std::vector<uint32_t> own_;       ///< of each leaf: its entry points
    std::unique_ptr<MetPlaces> met_;  ///< what rays met
    std::vector<std::vector<uint32_t>> some_;
    EntryPoints entries_;
};

/// Rays of a place that tell how the light of others reaches it: at most so many, and at least.
inline constexpr uint32_t kLinks = 64, kFewestLinks = 16;
/// Which light arrives at each leaf: its surface's, by rays from all over a group that holds it.
struct Links {
    std::vector<uint32_t> origin_of;  ///< of each leaf: the number of that group among all; kNone: none
    /// Of each of these groups: where what its rays meet begins, and the end of the last one; and all that.
    std::vector<uint32_t> first{0}, groups;
    /// Rays that leave the scene, and so see the sky: likewise, and their directions as octahedral codes.
    std::vector<uint32_t> first_open{0}, open;

    size_t origins() const { return first.size() - 1; }
    std::span<const uint32_t> groups_of(size_t origin) const {
        return std::span(groups).subspan(first[origin], first[origin + 1] - first[origin]);
    }
    std::span<const uint32_t> open_of(size_t origin) const {
        return std::span(open).subspan(first_open[origin], first_open[origin + 1] - first_open[origin]);
    }
    /// The share of the light of all rays that one of them brings.
    float share_of_one(size_t origin) const {
        const size_t count = groups_of(origin).size() + open_of(origin).size();
        return count > 0 ? 1 / static_cast<float>(count) : 0;
    }
    bool operator==(const Links&) const = default;
};

/// Traces links from what anything asks the light of: first from what the rays of gathering points meet, then
/// from what links meet.
class LinkBuilder {
 public:
    /// `reach`, m: of the cells from all over which links start, unless leaves are larger. The references
    /// must outlive it.
    LinkBuilder(const Surfaces& surfaces, const GroupBuilder& builder, const Groups& groups, float reach,
                uint64_t seed);
    /// Asks for the light of a group.
    void ask(uint32_t group);
    /// Traces some links. Returns whether any are left.
    bool advance();
    double share() const;

    /// Whether the light of each leaf is asked for.
    const std::vector<uint8_t>& used() const { return used_; }
    Links take() { return std::move(links_); }

 private:
    /// What the links of one group meet.
    struct Met {
        std::vector<uint32_t> groups, open;
    };
    std::vector<Side> sides_of(uint32_t group) const;
    uint32_t count_of(uint32_t group) const;
    Met trace(uint32_t group) const;

    const Surfaces& surfaces_;
    const GroupBuilder& builder_;
    const Groups& groups_;
    float reach_;
    uint64_t seed_;
    std::vector<uint8_t> asked_, used_;  ///< of each group; of each leaf
    std::vector<uint32_t> origins_;      ///< groups
    std::vector<uint32_t> number_of_;    ///< of each group: its place in origins_
    size_t next_ = 0;
    Links links_;
};

/// Vertices of a photon path, its entry point included: bounces 1 to 4.
inline constexpr uint32_t kVertices = 4;
/// Traces a path from each of the entry points [first, last): cosine directions at every vertex. Sets the
/// leaves of the kVertices - 1 vertices after each entry point, kNone where the path has left the scene.
void trace_photons(const Surfaces& surfaces, std::span<const uint32_t> leaf_of, const EntryPoints& entries,
                   size_t first, size_t last, uint64_t seed, std::span<uint32_t> leaves);

}  // namespace lucarne::gi::paths
