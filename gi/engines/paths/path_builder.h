#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/groups.h"
#include "gi/engines/paths/lamp_views.h"
#include "gi/engines/paths/light_paths.h"

namespace lucarne::gi::paths {

/// How fine light paths are to be.
struct PathPlan {
    Spacing spacing;
    uint32_t rays = 0;     ///< of each gathering point
    uint64_t entries = 0;  ///< entry points
    uint64_t seed = 0;
    std::optional<Bounds> lamps;  ///< where lamps will be, m; empty: anywhere
};

/// Makes light paths in parts, to be called in this order. Parts that return whether anything is left are
/// repeated until nothing is.
class PathBuilder {
 public:
    /// `surfaces` must outlive it.
    PathBuilder(const Surfaces& surfaces, const PathPlan& plan);

    bool choose_points() { return chooser_.advance(); }
    bool make_groups();
    bool join_groups();
    bool make_links() { return links_->advance(); }
    bool make_entries();
    bool make_photons();
    LightPaths take();

    /// The finished share, 0..1.
    double share() const;
    /// The gathering points so far. The other parts take less time, and are done again if they are
    /// interrupted.
    const PointChooser::State& points() const { return chooser_.state(); }
    bool restore(PointChooser::State state) { return chooser_.restore(std::move(state)); }

 private:
    const Surfaces& surfaces_;
    PathPlan plan_;
    PointChooser chooser_;
    std::optional<GroupBuilder> groups_;
    size_t next_connected_ = 0, next_ray_ = 0;  ///< hits: those before are connected, name their groups
    std::optional<LinkBuilder> links_;
    std::optional<LampViews> lamp_views_;
    std::optional<EntryChooser> entries_;
    size_t next_path_ = 0, last_path_ = 0;  ///< photon paths: the next one, all
    LightPaths paths_;
};

}  // namespace lucarne::gi::paths
