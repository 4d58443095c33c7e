#include "gi/engines/paths/light_paths.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/packing.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/engines/paths/lamp_views.h"
#include "gi/lighting/area_points.h"
#include "gi/shared/surfel_code.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "octree/tree/key.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kOriginsAtOnce = 2048, kOriginsAPiece = 16, kPathsAPiece = 1024, kLeavesAPiece = 1024,
                 kLeavesAtOnce = 65536;
/// Places that are tried for each entry point, and in how many steps they are ordered along a curve.
constexpr size_t kTried = 8;
/// Groups with at least this share of the area of the cells from which links start have all links, those with
/// a quarter of that half of them, and so on.
constexpr float kWholeArea = 0.25f;
constexpr float kCurve = 1023;
/// Entry points that each lamp should see where one knows where lamps will be, as a share of all.
constexpr double kSeenByLamp = 1;

/// Returns which of these sides lies at a share 0..1 of the area of all, in their order.
class ByArea {
 public:
    ByArea(const Surfaces& surfaces, std::span<const Side> sides) : sides_(sides) {
        for (const Side side : sides) {
            total_ += std::max(surfaces.area_of(side), 1e-12f);
            ends_.push_back(total_);
        }
    }
    Side at(double share) const {
        const auto found = std::ranges::upper_bound(ends_, share * total_);
        return sides_[std::min(static_cast<size_t>(found - ends_.begin()), sides_.size() - 1)];
    }

 private:
    std::span<const Side> sides_;
    std::vector<double> ends_;
    double total_ = 0;
};

/// A place on a side.
struct Place {
    Side side = kNone;
    glm::vec3 position{0.0f};
};

}  // namespace

/// The places of leaves that the rays of gathering points met. Rays count by the area for which their point
/// stands: there are many points in corners, and most of what they see no one else does.
class EntryChooser::MetPlaces {
 public:
    /// `points`: with their rays, chosen with `seed`. Those of leaves that are not `used` do not count. The
    /// references must outlive it.
    MetPlaces(const GroupBuilder& builder, std::span<const uint8_t> used, const PointChooser::State& points,
              uint64_t seed)
        : leaf_of_(builder.leaf_of()), used_(used), points_(points), seed_(seed), met_(builder.leaves(), 0) {
        weights_.assign(builder.leaves(), 0);
        each([&](size_t hit, uint32_t leaf) {
            ++met_[leaf];
            weights_[leaf] += weight_of(hit);
        });
    }
    /// How many rays met each leaf.
    std::span<const uint32_t> met() const { return met_; }
    /// Returns kTried times so many hits of each leaf, at the middles of equal parts of the weight of all in
    /// their order, which looks random.
    std::vector<std::vector<uint32_t>> choose_some(std::span<const uint32_t> own) const {
        std::vector<std::vector<uint32_t>> some(met_.size());
        std::vector<uint32_t> left = met_;
        std::vector<double> gone(met_.size(), 0);
        each([&](size_t hit, uint32_t leaf) {
            const size_t count = kTried * std::min(own[leaf], met_[leaf]);
            gone[leaf] += weight_of(hit);
            const bool is_last = --left[leaf] == 0;
            const double due = is_last ? static_cast<double>(count)
                                       : gone[leaf] / weights_[leaf] * static_cast<double>(count) - .5;
            while (some[leaf].size() < count && static_cast<double>(some[leaf].size()) < due)
                some[leaf].push_back(static_cast<uint32_t>(hit));
        });
        return some;
    }
    /// Returns places of leaves, even in each of them. `some`: of choose_some().
    std::vector<std::vector<Place>> choose(std::span<const std::vector<uint32_t>> some) const {
        std::vector<std::vector<Place>> chosen(some.size());
        parallel_ranges(chosen.size(), kLeavesAPiece, [&](size_t begin, size_t end) {
            for (size_t leaf = begin; leaf < end; ++leaf) chosen[leaf] = even_ones(some[leaf]);
        });
        return chosen;
    }

 private:
    template <class Visit>
    void each(const Visit& visit) const {
        for (size_t hit = 0; hit < points_.hits.size(); ++hit) {
            const Side side = points_.hits[hit].side;
            if (side != kNone && used_[leaf_of_[side]]) visit(hit, leaf_of_[side]);
        }
    }
    size_t rays() const { return points_.hits.size() / points_.points.size(); }
    double weight_of(size_t hit) const {
        const float reach = points_.points[hit / rays()].reach;
        return double{reach} * reach;
    }
    Place place_of(size_t hit) const {
        const GatheringPoint& point = points_.points[hit / rays()];
        return {points_.hits[hit].side, paths::place_of({point.position, point.normal, point.radius}, seed_,
                                                        point.side, static_cast<uint32_t>(hit % rays()),
                                                        static_cast<uint32_t>(rays()), points_.hits[hit])};
    }
    /// Returns the place of one of kTried hits each along a curve through space.
    std::vector<Place> even_ones(std::span<const uint32_t> hits) const {
        std::vector<Place> places;
        glm::vec3 low(3e38f), high(-3e38f);
        for (const uint32_t hit : hits) {
            places.push_back(place_of(hit));
            low = glm::min(low, places.back().position);
            high = glm::max(high, places.back().position);
        }
        const glm::vec3 size = high - low;
        const float edge = std::max({size.x, size.y, size.z, 1e-6f});
        std::vector<std::pair<uint64_t, uint32_t>> order;
        for (uint32_t i = 0; i < places.size(); ++i) {
            const glm::vec3 at = (places[i].position - low) * (kCurve / edge);
            order.emplace_back(octree::morton(static_cast<uint64_t>(at.x), static_cast<uint64_t>(at.y),
                                              static_cast<uint64_t>(at.z)),
                               i);
        }
        std::ranges::sort(order);
        std::vector<Place> even;
        for (size_t i = kTried / 2; i < order.size(); i += kTried) even.push_back(places[order[i].second]);
        return even;
    }

    std::span<const uint32_t> leaf_of_;
    std::span<const uint8_t> used_;
    const PointChooser::State& points_;
    uint64_t seed_;
    std::vector<uint32_t> met_;  ///< of each leaf: its rays
    std::vector<double> weights_;
};

uint32_t encode_place(const Surfel& disc, const glm::vec3& place) {
    glm::vec3 tangent, bitangent;
    tracing::frame_of(disc.normal, tangent, bitangent);
    const glm::vec3 offset = (place - disc.position) / disc.radius;
    return glm::packSnorm2x16({glm::dot(offset, tangent), glm::dot(offset, bitangent)});
}

glm::vec3 place_on(const Surfel& disc, uint32_t code) {
    glm::vec3 tangent, bitangent;
    tracing::frame_of(disc.normal, tangent, bitangent);
    const glm::vec2 offset = disc.radius * glm::unpackSnorm2x16(code);
    return disc.position + offset.x * tangent + offset.y * bitangent;
}

EntryChooser::EntryChooser(const Surfaces& surfaces, const GroupBuilder& builder,
                           std::span<const float> areas, std::span<const uint8_t> used,
                           const PointChooser::State& points, uint64_t seed, uint64_t count,
                           std::span<const float> seen)
    : surfaces_(surfaces),
      builder_(builder),
      own_(builder.leaves(), 0),
      met_(std::make_unique<MetPlaces>(builder, used, points, seed)) {
    double total = 0;
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf)
        if (used[leaf]) total += areas[leaf];
    for (uint32_t leaf = 0; leaf < builder.leaves(); ++leaf) {
        if (!used[leaf]) continue;
        const double share = total > 0 ? areas[leaf] / total : 0;
        own_[leaf] = static_cast<uint32_t>(std::clamp(std::round(share * static_cast<double>(count)), 1.0,
                                                      static_cast<double>(builder.sides_of(leaf).size())));
    }
    if (!seen.empty()) {
        // Places that rays met are as many different ones; more of them would be the same again.
        std::vector<uint32_t> limits(met_->met().begin(), met_->met().end());
        for (uint32_t leaf = 0; leaf < limits.size(); ++leaf)
            if (limits[leaf] == 0) limits[leaf] = own_[leaf];
        add_seen(own_, seen, limits, kSeenByLamp * static_cast<double>(count), static_cast<double>(count));
    }
    entries_.first.push_back(0);
}

EntryChooser::~EntryChooser() = default;

void EntryChooser::add(Side side, const glm::vec3& place) {
    const Side of_disc =
        surfaces_.is_part(side) ? surfaces_.parts()[side / 2 - surfaces_.discs()].side : side;
    entries_.sides.push_back(of_disc);
    entries_.places.push_back(encode_place(surfaces_.tracer().surfels()[of_disc / 2], place));
}

bool EntryChooser::advance() {
    if (some_.size() < own_.size()) {
        some_ = met_->choose_some(own_);
        return true;
    }
    const size_t begin = entries_.first.size() - 1, end = std::min(own_.size(), begin + kLeavesAtOnce);
    const std::vector<std::vector<Place>> places = met_->choose(std::span(some_).subspan(begin, end - begin));
    for (size_t leaf = begin; leaf < end; ++leaf) {
        for (const Place& place : places[leaf - begin]) add(place.side, place.position);
        if (own_[leaf] > 0 && places[leaf - begin].empty()) {
            const ByArea centres(surfaces_, builder_.sides_of(static_cast<uint32_t>(leaf)));
            for (uint32_t i = 0; i < own_[leaf]; ++i) {
                const Side side = centres.at((i + .5) / own_[leaf]);
                add(side, surfaces_.surfels()[side / 2].position);
            }
        }
        entries_.first.push_back(static_cast<uint32_t>(entries_.sides.size()));
    }
    return end < own_.size();
}

LinkBuilder::LinkBuilder(const Surfaces& surfaces, const GroupBuilder& builder, const Groups& groups,
                         float reach, uint64_t seed)
    : surfaces_(surfaces),
      builder_(builder),
      groups_(groups),
      reach_(reach),
      seed_(seed),
      asked_(groups.count(), 0),
      used_(groups.leaves, 0),
      number_of_(groups.count(), kNone) {
    links_.origin_of.assign(groups.leaves, kNone);
}

void LinkBuilder::ask(uint32_t group) {
    std::vector<uint32_t> open = {group};
    while (!open.empty()) {
        const uint32_t asked = open.back();
        open.pop_back();
        if (std::exchange(asked_[asked], 1)) continue;
        if (asked >= groups_.leaves) {
            const auto children = groups_.children_of(asked);
            open.insert(open.end(), children.begin(), children.end());
            continue;
        }
        used_[asked] = 1;
        const uint32_t origin = groups_.fitting(asked, reach_);
        if (number_of_[origin] == kNone) {
            number_of_[origin] = static_cast<uint32_t>(origins_.size());
            origins_.push_back(origin);
        }
        links_.origin_of[asked] = number_of_[origin];
    }
}

std::vector<Side> LinkBuilder::sides_of(uint32_t group) const {
    std::vector<Side> sides;
    std::vector<uint32_t> open = {group};
    while (!open.empty()) {
        const uint32_t part = open.back();
        open.pop_back();
        if (part < groups_.leaves) {
            const auto own = builder_.sides_of(part);
            sides.insert(sides.end(), own.begin(), own.end());
        } else {
            const auto children = groups_.children_of(part);
            open.insert(open.end(), children.begin(), children.end());
        }
    }
    return sides;
}

double LinkBuilder::share() const {
    return origins_.empty() ? 1 : static_cast<double>(next_) / static_cast<double>(origins_.size());
}

/// Returns how many links start from a group. Every second leaf is a sliver that a cell cuts off from a
/// surface: it sends little light, and the noise of its own counts as little.
uint32_t LinkBuilder::count_of(uint32_t group) const {
    const float share = groups_.area[group] / (reach_ * reach_);
    uint32_t count = kLinks;
    for (float least = kWholeArea; count > kFewestLinks && share < least; least /= 4) count /= 2;
    return count;
}

LinkBuilder::Met LinkBuilder::trace(uint32_t group) const {
    const std::vector<Side> sides = sides_of(group);
    const ByArea starts(surfaces_, sides);
    const double shift = Random(seed_, group).uniform();
    const uint32_t count = count_of(group);
    Met met;
    for (uint32_t link = 0; link < count; ++link) {
        // Places and directions are both even; a stride that is prime to their number makes them independent.
        const Side side = starts.at(((link * 29) % count + shift) / count);
        const RayStart start = start_at(surfaces_.surfels(), side);
        const glm::vec3 direction = cosine_direction(start.normal, even_point(link, seed_, group));
        float distance = 0;
        // Few links name groups as small as many: the means of larger ones bring light from farther away.
        const RayHit hit = follow(surfaces_, start, direction, kLinks, distance);
        if (hit.side != kNone)
            met.groups.push_back(groups_.fitting(groups_.leaf_of[hit.side], hit.width));
        else
            met.open.push_back(encode_octahedral(direction));
    }
    // Only their sum counts, and sorted numbers take less room in a file.
    std::ranges::sort(met.groups);
    return met;
}

bool LinkBuilder::advance() {
    const size_t first = next_, last = std::min(origins_.size(), first + kOriginsAtOnce);
    std::vector<Met> met(last - first);
    parallel_ranges(met.size(), kOriginsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) met[i] = trace(origins_[first + i]);
    });
    next_ = last;
    for (const Met& one : met) {
        for (const uint32_t group : one.groups) ask(group);
        links_.groups.insert(links_.groups.end(), one.groups.begin(), one.groups.end());
        links_.first.push_back(static_cast<uint32_t>(links_.groups.size()));
        links_.open.insert(links_.open.end(), one.open.begin(), one.open.end());
        links_.first_open.push_back(static_cast<uint32_t>(links_.open.size()));
    }
    return next_ < origins_.size();
}

void trace_photons(const Surfaces& surfaces, std::span<const uint32_t> leaf_of, const EntryPoints& entries,
                   size_t first, size_t last, uint64_t seed, std::span<uint32_t> leaves) {
    parallel_ranges(last - first, kPathsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const size_t entry = first + i;
            Side side = entries.sides[entry];
            RayStart start = start_at(surfaces.surfels(), side);
            start.position = place_on(surfaces.tracer().surfels()[side / 2], entries.places[entry]);
            for (uint32_t vertex = 1; vertex < kVertices; ++vertex) {
                uint32_t& leaf = leaves[i * (kVertices - 1) + vertex - 1];
                leaf = kNone;
                if (side == kNone) continue;
                if (vertex > 1) start = start_at(surfaces.surfels(), side);
                // Entry points stand beside each other in their order, so consecutive points are even
                // there as well.
                const glm::dvec2 at = even_point(static_cast<uint32_t>(entry), seed, vertex);
                float distance = 0;
                side = follow(surfaces, start, cosine_direction(start.normal, at), 1, distance).side;
                if (side != kNone) leaf = leaf_of[side];
            }
        }
    });
}

}  // namespace lucarne::gi::paths
