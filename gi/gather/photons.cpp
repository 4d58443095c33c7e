#include "gi/gather/photons.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/gather/light_sources.h"
#include "gi/lighting/area_points.h"
#include "gi/shared/lobe.h"
#include "gi/tracing/exposure.h"
#include "gi/tracing/scatter.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kPhotonsAtOnce = 65536, kPhotonsATask = 512, kLeavesATask = 4096;
/// The light of a surfel is the mean over nodes about it, up to one that has so many photons, or this many
/// levels further up. So flux stays within some surfels of where it arrived.
constexpr uint32_t kPhotonsOfANode = 16, kPointsOfANode = 16;
constexpr int kLevelsUp = 3;
constexpr int kMostCovers = 4;  ///< of a disc that others cover which are covered themselves
/// Nodes thicker than this share of their bound hold more than one surface, or a bent one.
constexpr float kFlat = 0.25f;

/// A side of a slot: the area of it that light can meet, m^2, and what arrived there.
struct Side {
    glm::vec3 flux{0.0f};        ///< W
    glm::vec3 directions{0.0f};  ///< where mirrors would send the photons, each times the mean of its flux
    float area = 0;
    uint32_t photons = 0, points = 0;  ///< points: those that tell the area

    void add(const Side& other) {
        flux += other.flux;
        directions += other.directions;
        area += other.area;
        photons += other.photons;
        points += other.points;
    }
};
using Sides = std::array<Side, 2>;  ///< front and back

/// Sets the sides of all nodes from those of the surfels.
void pull(const SurfelTree& tree, std::vector<Sides>& sides) {
    for_each_upward(tree, [&](size_t node) {
        for (size_t slot = 8 * node; slot < 8 * node + 8; ++slot)
            for_each_child(tree, slot, [&](size_t child) {
                const size_t front = facing(tree, slot, child).same ? 0 : 1;
                sides[slot][0].add(sides[child][front]);
                sides[slot][1].add(sides[child][1 - front]);
            });
    });
}

struct Photon {
    glm::vec3 origin, direction, flux;
};

/// Returns a photon that leaves a side at a direction that belongs to a point of the unit square.
std::optional<Photon> leave(const SideLobes& lobes, const LightSource& source, const Surfel& disc,
                            const glm::vec3& flux, const glm::dvec2& square) {
    const glm::vec3 normal = source.back ? -disc.normal : disc.normal;
    const glm::vec3 origin = tracing::offset_origin(disc.position, normal, disc.radius);
    if (!source.specular) return Photon{origin, tracing::cosine_power_direction(normal, 1, square), flux};
    const SideLight &both = lobes.light[source.surfel], &to = lobes.directions[source.surfel];
    const glm::vec3 light = source.back ? both.back : both.front;
    const glm::vec3 directions = source.back ? to.back : to.front;
    const float size = glm::length(directions);
    if (!(size > 0)) return std::nullopt;
    const float exponent = lobe_exponent(size / mean_colour(light));
    const glm::vec3 direction = tracing::cosine_power_direction(directions / size, exponent, square);
    const float cosine = glm::dot(direction, normal);
    if (!(cosine > 0)) return std::nullopt;
    // lobe_radiance() times the cosine, over the density of the direction.
    return Photon{origin, direction, flux * ((exponent + 2) / (exponent + 1) * cosine)};
}

/// Where a photon arrived.
struct Hit {
    uint32_t surfel = 0;  ///< of the tracer
    bool back = false;
    glm::vec3 flux{0.0f}, direction{0.0f};  ///< W; that of the photon
};

/// Follows photons from surface to surface.
class Walk {
 public:
    Walk(const tracing::SurfelTracer& tracer, std::span<const Material> materials,
         const ExchangeSettings& settings)
        : tracer_(tracer), materials_(materials), settings_(settings) {}

    /// Adds where a photon arrives.
    void follow(Photon photon, Random& random, std::vector<Hit>& hits) const {
        for (uint32_t bounce = 1;; ++bounce) {
            const auto hit = tracer_.first_hit(photon.origin, photon.direction);
            if (!hit) return;
            if (bounce == settings_.bounces || !settings_.only_last)
                hits.push_back({hit->surfel, hit->back, photon.flux, photon.direction});
            if (bounce == settings_.bounces) return;
            const Surfel& surfel = tracer_.surfels()[hit->surfel];
            const glm::vec3 normal = hit->back ? -surfel.normal : surfel.normal;
            const Reflectance surface =
                make_reflectance(materials_[surfel.material % materials_.size()], surfel.albedo);
            const auto scattered = tracing::scatter(surface, normal, -photon.direction, random);
            if (!scattered) return;
            // Roulette keeps the flux of photons about the same.
            const glm::vec3& weight = scattered->weight;
            const float survival = std::min(1.0f, std::max({weight.x, weight.y, weight.z}));
            if (!(random.uniform() < survival)) return;
            const glm::vec3 place = photon.origin + photon.direction * hit->distance;
            photon = {tracing::offset_origin(place, normal, surfel.radius), scattered->direction,
                      photon.flux * weight / survival};
        }
    }

 private:
    const tracing::SurfelTracer& tracer_;
    std::span<const Material> materials_;
    const ExchangeSettings& settings_;
};

/// Returns whether the irradiance of a side is known well.
bool known(const Side& side) {
    return side.photons >= kPhotonsOfANode && side.points >= kPointsOfANode;
}

/// Returns whether a slot holds one surface that is not bent.
bool flat(const SurfelTree& tree, size_t slot) {
    const WideNode& node = tree.nodes[slot / 8];
    return node.thickness[slot % 8] <= kFlat * node.bound[slot % 8];
}

}  // namespace

void Photons::set_surfels(const LitTree& scene, const TracedTree& traced, const std::atomic<bool>* stop) {
    const SurfelTree& tree = scene.tree();
    parent_of_.assign(tree.nodes.size(), kNoSurfel);
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot) {
        const int child = tree.nodes[slot / 8].child[slot % 8];
        if (child >= 0) parent_of_[static_cast<size_t>(child)] = static_cast<uint32_t>(slot);
    }
    exposures_ = tracing::exposures(*traced.tracer, stop);
    shown_.resize(2 * exposures_.size());
    for (uint32_t i = 0; i < shown_.size(); ++i) {
        shown_[i] = i;
        for (int covers = 0; covers < kMostCovers; ++covers) {
            const auto& [front, back] = exposures_[shown_[i] / 2];
            const tracing::Exposure& at = shown_[i] % 2 == 0 ? front : back;
            if (at.points > 0 || at.cover == tracing::kUncovered) break;
            shown_[i] = at.cover;
        }
    }
}

void Photons::trace(const LitTree& scene, const TracedTree& traced, std::span<const Material> materials,
                    const ExchangeSettings& settings, std::vector<SideLight>& light, SideLobes& lobes,
                    const std::atomic<bool>* stop) const {
    const SurfelTree& tree = scene.tree();
    const std::vector<Surfel>& surfels = traced.tracer->surfels();
    const std::vector<uint32_t>& slot_of = traced.slot_of;
    std::vector<Sides> sides(tree.surfels.size());
    std::vector<float> areas;
    areas.reserve(2 * slot_of.size());
    for (size_t i = 0; i < slot_of.size(); ++i) {
        const float area = kPi * surfels[i].radius * surfels[i].radius / tracing::kExposurePoints;
        const auto& [front, back] = exposures_[i];
        sides[slot_of[i]] = {Side{.area = area * static_cast<float>(front.points), .points = front.points},
                             Side{.area = area * static_cast<float>(back.points), .points = back.points}};
        for (const Side& side : sides[slot_of[i]]) areas.push_back(side.area);
    }
    const LightSources sources(traced.surfel_of, areas, light, lobes);
    const Walk walk(*traced.tracer, materials, settings);
    const uint64_t count = sources.total() > 0 ? settings.sources : 0;
    const double each = sources.total() / static_cast<double>(std::max<uint64_t>(count, 1));
    Random shifts(settings.seed, count);
    const double shift_u = shifts.uniform(), shift_v = shifts.uniform();
    std::vector<std::vector<Hit>> hits(kPhotonsAtOnce / kPhotonsATask);
    for (uint64_t first = 0; first < count && !(stop && *stop); first += kPhotonsAtOnce) {
        const size_t some = std::min<uint64_t>(kPhotonsAtOnce, count - first);
        for (std::vector<Hit>& found : hits) found.clear();
        parallel_ranges(some, kPhotonsATask, [&](size_t begin, size_t end) {
            for (uint64_t i = first + begin; i < first + end; ++i) {
                Random random(settings.seed, i);
                // Neighbours leave one after the other, in directions that are even among them.
                const auto number = static_cast<double>(i);
                const LightSource source =
                    sources.at((number + random.uniform()) / static_cast<double>(count));
                const glm::dvec2 square = glm::fract(glm::dvec2(shift_u, shift_v) + number * kR2);
                const glm::vec3 power = sources.flux(source);
                const glm::vec3 flux = power * static_cast<float>(each / mean_colour(power));
                const auto photon = leave(lobes, source, surfels[source.traced], flux, square);
                if (photon) walk.follow(*photon, random, hits[begin / kPhotonsATask]);
            }
        });
        // In their order, so that sums are the same on every run.
        for (const std::vector<Hit>& found : hits)
            for (const Hit& hit : found) {
                Side& side = sides[slot_of[hit.surfel]][hit.back ? 1 : 0];
                side.flux += hit.flux;
                const glm::vec3& normal = surfels[hit.surfel].normal;
                side.directions += mean_colour(hit.flux) * glm::reflect(hit.direction, normal);
                ++side.photons;
            }
    }
    pull(tree, sides);
    if (settings.only_last) clear_light(light, lobes);
    // Returns the side of a node that tells what a side of a leaf receives.
    const auto about = [&](size_t slot, size_t side) -> const Side& {
        for (int up = 0; up < kLevelsUp && !known(sides[slot][side]); ++up) {
            const uint32_t parent = parent_of_[slot / 8];
            // Where no disc is exposed, a bent surface tells more than none.
            const bool none = !(sides[slot][side].area > 0);
            if (parent == kNoSurfel || (!none && !flat(tree, parent))) break;
            if (!facing(tree, parent, slot).same) side = 1 - side;
            slot = parent;
        }
        return sides[slot][side];
    };
    parallel_ranges(slot_of.size(), kLeavesATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const Reflectance r =
                make_reflectance(materials[surfels[i].material % materials.size()], surfels[i].albedo);
            for (size_t side = 0; side < 2; ++side) {
                const uint32_t shown = shown_[2 * i + side];
                const Side& near = about(slot_of[shown / 2], shown % 2);
                if (!(near.area > 0)) continue;
                add_reflected(r, {near.flux / near.area, near.directions / near.area}, traced.surfel_of[i],
                              side == 1, light, lobes);
            }
        }
    });
}

}  // namespace lucarne::gi
