#include "gi/engines/paths/surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>
#include <xxhash.h>

#include "gi/shared/edge.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// Places near the rim of a disc that are tested, at this share of its radius: pairs lie opposite each other.
constexpr size_t kPlaces = 6;
constexpr float kNearRim = 0.9f, kBeforeEdge = 0.95f;
/// The share of a disc's area of each place that is cut off: at most half of it is, as its centre counts too.
constexpr float kShareOfPlace = 0.5f / kPlaces;
constexpr size_t kSidesATask = 4096, kSidesAtOnce = 16 * kSidesATask;

}  // namespace

Surfaces::Surfaces(std::unique_ptr<tracing::SurfelTracer> tracer)
    : tracer_(std::move(tracer)), most_(kPlaces), first_(2 * discs() + 1, 0), is_cut_(2 * discs(), false) {}

bool Surfaces::find_parts() {
    struct Found {
        std::vector<CutOffPart> parts;
        std::vector<float> shares;
    };
    const size_t begin_side = next_, end_side = std::min(next_ + kSidesAtOnce, 2 * discs());
    std::vector<Found> found((end_side - begin_side + kSidesATask - 1) / kSidesATask);
    parallel_ranges(found.size(), 1, [&](size_t begin, size_t end) {
        for (size_t task = begin; task < end; ++task) {
            const size_t first = begin_side + task * kSidesATask;
            for (size_t side = first; side < std::min(end_side, first + kSidesATask); ++side) {
                float share = 0;
                const std::vector<CutOffPart> own = parts_cut_off(static_cast<Side>(side), share);
                if (own.size() > most_) continue;
                found[task].parts.insert(found[task].parts.end(), own.begin(), own.end());
                found[task].shares.insert(found[task].shares.end(), own.size(), share);
            }
        }
    });
    for (const Found& some : found) {
        parts_.insert(parts_.end(), some.parts.begin(), some.parts.end());
        shares_.insert(shares_.end(), some.shares.begin(), some.shares.end());
    }
    while (parts_.size() > kMostParts * discs()) keep_sides_with(--most_);
    next_ = end_side;
    if (next_ < 2 * discs()) return true;
    std::ranges::fill(first_, 0);
    for (const CutOffPart& part : parts_) {
        is_cut_[part.side] = true;
        ++first_[part.side + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    return false;
}

/// Drops the parts of sides that have more than `parts`. Which sides are left does not depend on when that
/// happens.
void Surfaces::keep_sides_with(size_t parts) {
    size_t kept = 0;
    for (size_t first = 0; first < parts_.size();) {
        size_t last = first + 1;
        while (last < parts_.size() && parts_[last].side == parts_[first].side) ++last;
        if (last - first <= parts)
            for (size_t i = first; i < last; ++i, ++kept) {
                parts_[kept] = parts_[i];
                shares_[kept] = shares_[i];
            }
        first = last;
    }
    parts_.resize(kept);
    shares_.resize(kept);
}

uint64_t Surfaces::parts_key() const {
    std::vector<Side> sides;
    for (const CutOffPart& part : parts_) sides.push_back(part.side);
    return XXH3_64bits(sides.data(), sides.size() * sizeof(Side));
}

/// Returns a place a radius above one of a disc's side, or of its parts.
glm::vec3 Surfaces::above(Side side, const glm::vec3& place) const {
    const std::span discs(tracer_->surfels());
    return tracing::offset_origin(place, normal_of(discs, side), discs[side / 2].radius);
}

/// Finds the parts of a side; sets the share of the disc's area that each of them has.
std::vector<CutOffPart> Surfaces::parts_cut_off(Side side, float& share) const {
    const Surfel& disc = tracer_->surfels()[side / 2];
    glm::vec3 tangent, bitangent;
    tracing::frame_of(disc.normal, tangent, bitangent);
    std::array<glm::vec3, kPlaces> places, above_places;
    for (size_t i = 0; i < kPlaces; ++i) {
        const float angle = static_cast<float>(2 * M_PI / kPlaces) * static_cast<float>(i);
        glm::vec3 offset = kNearRim * disc.radius * (std::cos(angle) * tangent + std::sin(angle) * bitangent);
        const float beyond = glm::dot(disc.edge, offset);
        if (beyond > kBeforeEdge) offset *= kBeforeEdge / beyond;
        places[i] = disc.position + offset;
        above_places[i] = above(side, places[i]);
    }
    // Most discs are whole, which three rays across show.
    bool is_whole = true;
    for (size_t i = 0; i < kPlaces / 2 && is_whole; ++i)
        is_whole = !tracer_->occluded(above_places[i], above_places[i + kPlaces / 2]);
    std::vector<CutOffPart> parts;
    if (is_whole) return parts;
    const glm::vec3 centre = above(side, disc.position);
    float cut_off = 0;
    for (size_t i = 0; i < kPlaces; ++i) {
        if (!tracer_->occluded(centre, above_places[i])) continue;
        ++cut_off;
        if (std::ranges::none_of(parts, [&](const CutOffPart& part) {
                return !tracer_->occluded(above(side, part.position), above_places[i]);
            }))
            parts.push_back({side, places[i]});
    }
    if (!parts.empty()) share = kShareOfPlace * cut_off / static_cast<float>(parts.size());
    return parts;
}

std::span<const CutOffPart> Surfaces::parts_of(Side side) const {
    if (is_part(side) || !is_cut_[side]) return {};
    return std::span(parts_).subspan(first_[side], first_[side + 1] - first_[side]);
}

float Surfaces::area_of(Side side) const {
    const size_t part = side / 2 - discs();
    const Side of_disc = is_part(side) ? parts_[part].side : side;
    const float own = tracer_->surfels()[of_disc / 2].area;
    const float area = own > 0 && std::isfinite(own) ? own : 0;
    if (is_part(side)) return shares_[part] * area;
    float share = 1;
    for (uint32_t i = first_[side]; i < first_[side + 1]; ++i) share -= shares_[i];
    return share * area;
}

Side Surfaces::side_of(const tracing::SurfelTracer::Hit& hit, const glm::vec3& place) const {
    const Side side = 2 * hit.surfel + (hit.back ? 1u : 0u);
    if (!is_cut_[side]) return side;
    if (!tracer_->occluded(above(side, tracer_->surfels()[hit.surfel].position), above(side, place)))
        return side;
    const auto nearest = std::ranges::min_element(
        parts_of(side), {}, [&](const CutOffPart& part) { return glm::distance(part.position, place); });
    return side_of_part(*nearest);
}

bool Surfaces::see_each_other(Side one, Side other) const {
    const auto start = [&](Side side) {
        const Surfel surfel = surfels()[side / 2];
        return tracing::offset_origin(surfel.position, side % 2 ? -surfel.normal : surfel.normal,
                                      surfel.radius);
    };
    return !tracer_->occluded(start(one), start(other));
}

}  // namespace lucarne::gi::paths
