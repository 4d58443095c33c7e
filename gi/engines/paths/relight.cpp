#include "gi/engines/paths/relight.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/lighting/lobe_albedo.h"
#include "gi/lighting/lobe_cells.h"
#include "gi/shared/brdf.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// Of groups: narrower ones would fall between gathering points, which are too far apart for them.
constexpr float kLargestLobe = LobeCells::kLargestExponent;

template <class Light>
const Light kDark{};
template <>
const glm::vec3 kDark<glm::vec3>{0.0f};

constexpr size_t kGroupsATask = 1024, kPointsATask = 64, kEntriesATask = 4096;

/// The light of all groups, for sums of single ones from all over: each is read by one instruction, and kNone
/// by no branch.
class LightOfGroups {
 public:
    explicit LightOfGroups(std::span<const glm::vec3> light) : dark_(static_cast<uint32_t>(light.size())) {
        light_.reserve(light.size() + 1);
        for (const glm::vec3& one : light) light_.emplace_back(one, 0);
        light_.emplace_back(0.0f);
    }
    /// Returns the sum over these groups, in their order.
    glm::vec3 sum(std::span<const uint32_t> groups) const {
        glm::vec4 sum(0.0f);
        for (const uint32_t group : groups) sum += light_[std::min(group, dark_)];
        return sum;
    }

 private:
    uint32_t dark_;  ///< number of one without light, after the last
    std::vector<glm::vec4> light_;
};

}  // namespace

/// Returns the irradiance by the sky, W/m^2, of the groups from which links start.
std::vector<glm::vec3> Relight::light_of_sky(const GatherSky& sky) const {
    const Links& links = bake_->paths.links;
    std::vector<glm::vec3> arriving(links.origins(), glm::vec3(0.0f));
    parallel_ranges(arriving.size(), kGroupsATask, [&](size_t begin, size_t end) {
        for (size_t origin = begin; origin < end; ++origin) {
            glm::vec3 sum(0.0f);
            for (const uint32_t code : links.open_of(origin)) sum += sky.radiance(decode_octahedral(code));
            arriving[origin] = kPi * links.share_of_one(origin) * sum;
        }
    });
    return arriving;
}

void Relight::enter(std::span<const Material> materials, std::span<const glm::vec3> irradiance,
                    const GatherSky* sky, std::span<const glm::vec3> directions) {
    const LightPaths& paths = bake_->paths;
    const EntryPoints& points = paths.entries;
    const uint32_t leaves = paths.groups.leaves;
    energies_.resize(bake_->entries.size());
    first_.assign(leaves, glm::vec3(0.0f));
    reflectances_.assign(leaves, glm::vec3(0.0f));
    std::vector<glm::vec3> of_sky;
    if (sky && !sky->texels.empty()) of_sky = light_of_sky(*sky);
    LobeAlbedos lobes;
    lobes.take(materials);
    lobes_.assign(lobes.empty() || directions.empty() ? 0 : leaves, {});
    by_lobes_.assign(lobes_.size(), glm::vec3(0.0f));
    lobe_light_.clear();
    parallel_ranges(leaves, kGroupsATask, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf) {
            const uint32_t first = points.first[leaf], last = points.first[leaf + 1];
            const float share = 1 / static_cast<float>(std::max(last - first, 1u));
            const uint32_t origin = of_sky.empty() ? kNone : paths.links.origin_of[leaf];
            const glm::vec3 everywhere = origin == kNone ? glm::vec3(0.0f) : of_sky[origin];
            for (uint32_t i = first; i < last; ++i) {
                const Entry& entry = bake_->entries[i];
                const Material& material = materials[entry.material % materials.size()];
                const Reflectance r = make_reflectance(material, entry.albedo);
                const LobeAlbedo* lobe = r.ks > 0 ? lobes.find(r.exponent) : nullptr;
                const glm::vec3 reflectance = r.kd + (lobe ? r.ks * lobe->mean() : 0);
                glm::vec3 of_lamps = reflectance * irradiance[i];
                if (lobe && !lobes_.empty()) {
                    const glm::vec3 by_lobe =
                        r.ks * lobe->at(glm::dot(directions[i], entry.normal)) * irradiance[i];
                    of_lamps = r.kd * irradiance[i] + by_lobe;
                    by_lobes_[leaf] += share * by_lobe;
                    lobes_[leaf] += LampLobe::of(r, entry.normal, directions[i], irradiance[i]) * share;
                }
                energies_[i] = kPi * glm::vec3(material.emission) + of_lamps + reflectance * everywhere;
                first_[leaf] += share * energies_[i];
                reflectances_[leaf] += share * reflectance;
            }
        }
    });
}

/// Sets the light of larger groups to the mean of their children, by area.
template <class Light>
void Relight::coarsen(std::vector<Light>& light) const {
    const Groups& groups = bake_->paths.groups;
    light.resize(groups.count());
    uint32_t begin = groups.leaves;
    for (const uint32_t end : groups.level_ends) {
        parallel_ranges(end - begin, kGroupsATask, [&](size_t first, size_t last) {
            for (size_t i = begin + first; i < begin + last; ++i) {
                const size_t larger = i - groups.leaves;
                const auto children =
                    std::span(groups.children)
                        .subspan(groups.first[larger], groups.first[larger + 1] - groups.first[larger]);
                Light sum = kDark<Light>;
                for (const uint32_t child : children) sum += light[child] * groups.area[child];
                light[i] = groups.area[i] > 0 ? sum / groups.area[i] : kDark<Light>;
            }
        });
        begin = end;
    }
}

void Relight::follow_links(const std::vector<glm::vec3>& from, std::vector<glm::vec3>& to) const {
    const Links& links = bake_->paths.links;
    const LightOfGroups light(from);
    std::vector<glm::vec3> arriving(links.origins(), glm::vec3(0.0f));
    parallel_ranges(arriving.size(), kGroupsATask, [&](size_t begin, size_t end) {
        for (size_t origin = begin; origin < end; ++origin)
            arriving[origin] = links.share_of_one(origin) * light.sum(links.groups_of(origin));
    });
    to.assign(links.origin_of.size(), glm::vec3(0.0f));
    parallel_ranges(to.size(), kGroupsATask, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf)
            if (links.origin_of[leaf] != kNone)
                to[leaf] = reflectances_[leaf] * arriving[links.origin_of[leaf]];
    });
}

void Relight::make_photon_index() {
    const LightPaths& paths = bake_->paths;
    const Links& links = paths.links;
    const size_t count = bake_->entries.size();
    areas_.assign(links.origins(), 0);
    for (size_t leaf = 0; leaf < paths.groups.leaves; ++leaf)
        if (links.origin_of[leaf] != kNone) areas_[links.origin_of[leaf]] += paths.groups.area[leaf];
    index_.resize(kVertices - 1);
    for (uint32_t vertex = 0; vertex + 1 < kVertices; ++vertex) {
        const auto origin_of = [&](size_t entry) {
            const uint32_t leaf = paths.photons[entry * (kVertices - 1) + vertex];
            return leaf == kNone ? kNone : links.origin_of[leaf];
        };
        PhotonIndex& index = index_[vertex];
        index.first.assign(links.origins() + 1, 0);
        for (size_t i = 0; i < count; ++i)
            if (origin_of(i) != kNone) ++index.first[origin_of(i) + 1];
        std::partial_sum(index.first.begin(), index.first.end(), index.first.begin());
        index.entries.resize(index.first.back());
        std::vector<uint32_t> next = index.first;
        for (size_t i = 0; i < count; ++i)
            if (origin_of(i) != kNone) index.entries[next[origin_of(i)]++] = static_cast<uint32_t>(i);
    }
}

/// Reflects every photon at this vertex of its path, from 1, and sets the radiosity of the leaves by the sum
/// of the photons' energies over the area (Yue et al. 2007, section 6.2, without bins of directions, since
/// light leaves evenly). Photons and area are those of the groups from which links start: rims of discs that
/// stick out are leaves with less area than rays meet, and would look too bright to the same rays.
void Relight::follow_photons(uint32_t vertex, std::vector<glm::vec3>& to) {
    const LightPaths& paths = bake_->paths;
    if (index_.empty()) make_photon_index();
    const PhotonIndex& index = index_[vertex - 1];
    std::vector<glm::vec3> arriving(areas_.size(), glm::vec3(0.0f));
    parallel_ranges(arriving.size(), kGroupsATask, [&](size_t begin, size_t end) {
        for (size_t origin = begin; origin < end; ++origin) {
            if (!(areas_[origin] > 0)) continue;
            for (uint32_t i = index.first[origin]; i < index.first[origin + 1]; ++i)
                arriving[origin] += energies_[index.entries[i]];
            arriving[origin] /= areas_[origin];
        }
    });
    to.assign(paths.groups.leaves, glm::vec3(0.0f));
    for (size_t leaf = 0; leaf < to.size(); ++leaf)
        if (const uint32_t origin = paths.links.origin_of[leaf]; origin != kNone)
            to[leaf] = reflectances_[leaf] * arriving[origin];
    parallel_ranges(energies_.size(), kEntriesATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const uint32_t leaf = paths.photons[i * (kVertices - 1) + vertex - 1];
            energies_[i] = leaf == kNone ? glm::vec3(0.0f) : energies_[i] * reflectances_[leaf];
        }
    });
}

void Relight::bounce(const Bounces& bounces, Transport transport) {
    const LightPaths& paths = bake_->paths;
    std::vector<glm::vec3> light = first_, next;
    sum_.assign(paths.groups.count(), glm::vec3(0.0f));
    if (transport == Transport::photons) {
        // From here on energies_ holds those of the photons, W.
        for (uint32_t leaf = 0; leaf < paths.groups.leaves; ++leaf) {
            const uint32_t first = paths.entries.first[leaf], last = paths.entries.first[leaf + 1];
            for (uint32_t i = first; i < last; ++i)
                energies_[i] *= paths.groups.area[leaf] / static_cast<float>(last - first);
        }
    }
    for (uint32_t bounce = 1; bounce <= bounces.last; ++bounce) {
        coarsen(light);
        if (bounce >= bounces.first)
            for (size_t i = 0; i < sum_.size(); ++i) sum_[i] += light[i];
        if (bounce == 1 && bounces.first == 1 && !lobes_.empty()) shine_by_lobes();
        if (bounce == bounces.last) break;
        if (transport == Transport::photons) {
            if (bounce == kVertices) break;
            follow_photons(bounce, next);
        } else {
            follow_links(light, next);
        }
        std::swap(light, next);
    }
}

/// Takes the part of lobes from the light that leaves evenly, and gives each gathering ray that of its group.
void Relight::shine_by_lobes() {
    const LightPaths& paths = bake_->paths;
    std::vector<glm::vec3> even = by_lobes_;
    coarsen(even);
    for (size_t i = 0; i < sum_.size(); ++i) sum_[i] = glm::max(sum_[i] - even[i], 0.0f);
    std::vector<LampLobe> of_groups = lobes_;
    coarsen(of_groups);
    std::vector<MeanLobe> lobes;
    lobes.reserve(of_groups.size());
    for (const LampLobe& lobe : of_groups) lobes.emplace_back(lobe, kLargestLobe);
    if (std::none_of(lobes.begin(), lobes.end(), [](const MeanLobe& lobe) { return lobe.shines(); })) return;
    lobe_light_.assign(paths.rays.size(), glm::vec3(0.0f));
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = paths.points[i];
            const CosineDirections directions(point.normal, bake_->seed, point.side);
            for (uint32_t ray = 0; ray < paths.rays_a_point; ++ray)
                if (const uint32_t group = paths.rays[i * paths.rays_a_point + ray];
                    group != kNone && lobes[group].shines())
                    lobe_light_[i * paths.rays_a_point + ray] = lobes[group].radiosity(-directions[ray]);
        }
    });
}

std::vector<glm::vec3> Relight::gather() const {
    const LightPaths& paths = bake_->paths;
    std::vector<glm::vec3> irradiance(paths.points.size());
    const float share = 1 / static_cast<float>(paths.rays_a_point);
    const LightOfGroups light(sum_);
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            irradiance[i] =
                share * light.sum(std::span(paths.rays).subspan(i * paths.rays_a_point, paths.rays_a_point));
            if (lobe_light_.empty()) continue;
            for (uint32_t ray = 0; ray < paths.rays_a_point; ++ray)
                irradiance[i] += share * lobe_light_[i * paths.rays_a_point + ray];
        }
    });
    return irradiance;
}

}  // namespace lucarne::gi::paths
