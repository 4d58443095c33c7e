#include "gi/engines/paths/path_builder.h"

#include <algorithm>
#include <span>
#include <utility>

#include "io/core/log.h"

namespace lucarne::gi::paths {
namespace {

/// Of the smallest cells, in R+; at most R-. Larger ones hold patches of sun and what no gathering point sees
/// of them.
constexpr float kLeastCell = 0.5f;
/// Of the width of a gathering ray, into which the group fits that it names: the means of larger ones bring
/// light of parts that the point does not see.
constexpr float kRayShare = 0.5f;
/// Of the cells from all over which links start, in R+; at least R-: light of further bounces is smooth.
constexpr float kLinkReach = 0.5f;
constexpr size_t kPathsAtOnce = 131072, kHitsAtOnce = 2u << 20;
/// Shares of the work: gathering points, links; the rest are photons.
constexpr double kPointsShare = 0.75, kLinksShare = 0.2;

}  // namespace

PathBuilder::PathBuilder(const Surfaces& surfaces, const PathPlan& plan)
    : surfaces_(surfaces), plan_(plan), chooser_(surfaces, plan.spacing, plan.rays, plan.seed) {}

bool PathBuilder::make_groups() {
    const PointChooser::State& state = chooser_.state();
    if (groups_) return groups_->divide();
    groups_.emplace(surfaces_, state.hits, std::min(kLeastCell * state.spacing.most, state.spacing.least));
    return true;
}

bool PathBuilder::join_groups() {
    const PointChooser::State& state = chooser_.state();
    const std::span<const uint32_t> leaf_of = groups_->leaf_of();
    if (next_connected_ < state.hits.size()) {
        const size_t last = std::min(state.hits.size(), next_connected_ + kHitsAtOnce);
        for (size_t i = next_connected_; i < last; ++i)
            if (state.hits[i].side != kNone)
                groups_->connect(leaf_of[state.points[i / plan_.rays].side], leaf_of[state.hits[i].side]);
        next_connected_ = last;
        return true;
    }
    if (!links_) {
        if (groups_->join()) return true;
        paths_.groups = groups_->take();
        links_.emplace(surfaces_, *groups_, paths_.groups,
                       std::max(kLinkReach * state.spacing.most, state.spacing.least), plan_.seed);
        paths_.rays_a_point = plan_.rays;
        paths_.rays.reserve(state.hits.size());
        return next_ray_ < state.hits.size();
    }
    const size_t last = std::min(state.hits.size(), next_ray_ + kHitsAtOnce);
    for (; next_ray_ < last; ++next_ray_) {
        const RayHit& hit = state.hits[next_ray_];
        const bool met = hit.side != kNone;
        paths_.rays.push_back(met ? paths_.groups.fitting(leaf_of[hit.side], kRayShare * hit.width) : kNone);
        if (met) links_->ask(paths_.rays.back());
    }
    return next_ray_ < state.hits.size();
}

bool PathBuilder::make_entries() {
    if (plan_.lamps && !lamp_views_)
        lamp_views_.emplace(surfaces_, groups_->leaf_of(), groups_->leaves(), *plan_.lamps);
    if (!entries_) {
        if (lamp_views_ && lamp_views_->advance()) return true;
        if (lamp_views_ && std::ranges::all_of(lamp_views_->seen(), [](float seen) { return seen == 0; }))
            log::warn("lighting_region: no surface is seen from there, so it changes nothing");
        entries_.emplace(
            surfaces_, *groups_, paths_.groups.area, links_->used(), chooser_.state(), plan_.seed,
            plan_.entries,
            lamp_views_ ? std::span<const float>(lamp_views_->seen()) : std::span<const float>());
        return true;
    }
    if (entries_->advance()) return true;
    paths_.entries = entries_->take();
    entries_.reset();
    paths_.links = links_->take();
    last_path_ = paths_.entries.sides.size();
    paths_.photons.assign(last_path_ * (kVertices - 1), kNone);
    return false;
}

bool PathBuilder::make_photons() {
    const size_t last = std::min(last_path_, next_path_ + kPathsAtOnce);
    trace_photons(surfaces_, groups_->leaf_of(), paths_.entries, next_path_, last, plan_.seed,
                  std::span(paths_.photons).subspan(next_path_ * (kVertices - 1)));
    next_path_ = last;
    return next_path_ < last_path_;
}

LightPaths PathBuilder::take() {
    paths_.points = chooser_.state().points;  // the state may still have to be kept
    paths_.groups.leaf_of.clear();
    return std::move(paths_);
}

double PathBuilder::share() const {
    if (!groups_) return kPointsShare * chooser_.share();
    const double traced =
        last_path_ > 0 ? static_cast<double>(next_path_) / static_cast<double>(last_path_) : 0;
    const bool all_asked = links_ && next_ray_ == chooser_.state().hits.size();
    return kPointsShare + kLinksShare * (all_asked ? links_->share() : 0) +
           (1 - kPointsShare - kLinksShare) * traced;
}

}  // namespace lucarne::gi::paths
