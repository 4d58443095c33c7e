#include "gi/gather/radiosity.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kSurfelsATask = 16384;
/// Micro-buffers of up to so many rays are kept: about 85 MB. More are drawn again for each reflection.
constexpr size_t kMostRaysHeld = size_t{1} << 24;
/// A node is thick over this share of its bound. Its surfels see different things, so it is divided until it
/// is this much smaller than flat ones.
constexpr float kThickPlace = 0.25f, kThickShare = 0.25f;

/// Calls visit(slot) for the highest slots that are no larger than `size`; stops once there were more than
/// `most`. Returns their number.
template <class Visit>
size_t for_each_slot(const SurfelTree& tree, float size, size_t most, const Visit& visit) {
    std::vector<uint32_t> waiting{0};
    size_t found = 0;
    while (!waiting.empty() && found <= most) {
        const uint32_t at = waiting.back();
        waiting.pop_back();
        const WideNode& node = tree.nodes[at];
        for (uint32_t k = 0; k < 8; ++k) {
            if (node.child[k] == kNoChild) continue;
            const float bound = node.bound[k];
            const bool flat = node.thickness[k] <= kThickPlace * bound;
            if (node.child[k] == kLeafChild || bound <= (flat ? size : kThickShare * size)) {
                ++found;
                visit(8 * at + k);
            } else {
                waiting.push_back(static_cast<uint32_t>(node.child[k]));
            }
        }
    }
    return found;
}

/// Calls visit(surfel) for all surfels of a slot.
template <class Visit>
void for_each_surfel(const SurfelTree& tree, uint32_t slot, const Visit& visit) {
    std::vector<uint32_t> waiting{slot};
    while (!waiting.empty()) {
        const uint32_t at = waiting.back();
        waiting.pop_back();
        const int child = tree.nodes[at / 8].child[at % 8];
        if (child == kLeafChild) visit(tree.surfels[at]);
        for (uint32_t k = 0; child >= 0 && k < 8; ++k)
            if (tree.nodes[static_cast<size_t>(child)].child[k] != kNoChild)
                waiting.push_back(8 * static_cast<uint32_t>(child) + k);
    }
}

/// Draws a surfel of a slot in proportion to area.
uint32_t draw_surfel(const SurfelTree& tree, uint32_t slot) {
    Random random(slot);
    for (;;) {
        const int child = tree.nodes[slot / 8].child[slot % 8];
        if (child == kLeafChild) return tree.surfels[slot];
        const float* areas = &tree.areas[8 * static_cast<size_t>(child)];
        double sum = 0;
        uint32_t drawn = 0;
        for (uint32_t k = 0; k < 8; ++k) {
            sum += areas[k];
            if (areas[k] > 0 && random.uniform() * sum < areas[k]) drawn = k;
        }
        slot = 8 * static_cast<uint32_t>(child) + drawn;
    }
}

glm::vec3 normal_of(const FlatSurfel& surfel) {
    return decode_octahedral(surfel.normal);
}

}  // namespace

void Radiosity::choose_places(const LitTree& scene, uint32_t level) {
    const SurfelTree& tree = scene.tree();
    points_.clear();
    place_of_.assign(scene.surfels().size(), kNoSurfel);
    if (tree.empty()) return;
    const size_t most = size_t{1} << level;
    float low = 0, high = 0;
    for (size_t k = 0; k < 8; ++k)
        if (tree.nodes[0].child[k] != kNoChild) high = std::max(high, 4 * tree.nodes[0].bound[k]);
    for (int i = 0; i < 24; ++i) {
        const float size = 0.5f * (low + high);
        (for_each_slot(tree, size, most, [](uint32_t) {}) <= most ? high : low) = size;
    }
    std::vector<uint32_t> slots;
    for_each_slot(tree, high, most, [&](uint32_t slot) { slots.push_back(slot); });
    points_.resize(2 * slots.size());
    for (uint32_t place = 0; place < slots.size(); ++place) {
        const uint32_t drawn = draw_surfel(tree, slots[place]);
        const FlatSurfel& surfel = scene.surfels()[drawn];
        const glm::vec3 normal = normal_of(surfel);
        for (const float side : {1.0f, -1.0f})
            points_[2 * place + (side < 0)] = {.position = {surfel.x, surfel.y, surfel.z},
                                               .lift = surfel.radius,
                                               .normal = side * normal,
                                               .seed = 0,
                                               .viewer = glm::vec3(0.0f),
                                               .exponent = 0,
                                               .axis = side * normal,
                                               .scale = 1};
        for_each_surfel(tree, slots[place], [&](uint32_t s) { place_of_[s] = place; });
    }
}

Result<void> Radiosity::gather(ClDevice& device, Gatherer& gatherer, Gathered what, const Settings& settings,
                               std::span<const GatherPoint> points, std::span<glm::vec3> gathered,
                               const std::atomic<bool>* stop) {
    if (points.size() * settings.side * settings.side > kMostRaysHeld) {
        std::vector<glm::vec4> light(points.size());
        LUCARNE_TRY(gatherer.gather(device, what, points, settings.side, settings.seed, light, stop));
        for (size_t i = 0; i < light.size(); ++i) gathered[i] = glm::vec3(light[i]);
        return {};
    }
    LUCARNE_TRY(gatherer.see(device, points, settings.side, settings.seed, buffers_, stop));
    if (stop && *stop) return {};
    LUCARNE_ASSIGN(const auto light, gatherer.shade(device, what, buffers_));
    for (size_t i = 0; i < light.size(); ++i) gathered[i] = light[i].on(points[i].normal);
    return {};
}

Result<void> Radiosity::compute(ClDevice& device, const LitTree& scene, Gatherer& gatherer,
                                const Settings& settings, std::vector<SideLight>& light,
                                const std::atomic<bool>* stop) {
    const auto own = scene.own_light();
    const auto reflectances = scene.reflectances();
    light.assign(own.begin(), own.end());
    std::vector<SideLight> last = light, slots;
    std::vector<GatherPoint> points = points_;
    for (size_t i = 0; i < points.size(); ++i)
        points[i].seed = static_cast<uint32_t>(mix64(settings.seed, i));
    std::vector<glm::vec3> gathered(points.size(), glm::vec3(0.0f));
    // Returns what a surfel reflects of the light that its place gathered.
    const auto reflected = [&](size_t i) -> SideLight {
        const uint32_t place = place_of_[i];
        if (place == kNoSurfel) return {};
        const bool same = glm::dot(normal_of(scene.surfels()[i]), points[2 * place].normal) >= 0;
        const glm::vec3 front = kPi * gathered[2 * place + (same ? 0 : 1)];
        const glm::vec3 back = kPi * gathered[2 * place + (same ? 1 : 0)];
        return {reflectances[i] * front, reflectances[i] * back};
    };
    if (settings.sky) {
        LUCARNE_TRY(gather(device, gatherer, Gathered::sky, settings, points, gathered, stop));
        if (stop && *stop) return {};
        parallel_ranges(last.size(), kSurfelsATask, [&](size_t first, size_t end) {
            for (size_t i = first; i < end; ++i) {
                const SideLight sky = reflected(i);
                last[i].front += sky.front;
                last[i].back += sky.back;
            }
        });
        light = last;
    }
    for (uint32_t bounce = 0; bounce < settings.bounces; ++bounce) {
        pull_light(scene.tree(), last, slots);
        LUCARNE_TRY(gatherer.set_light(device, slots));
        const SideLobes none;
        LUCARNE_TRY(gatherer.set_lobes(device, bounce == 0 ? scene.lobes() : none));
        LUCARNE_TRY(gather(device, gatherer, Gathered::light_of_surfels, settings, points, gathered, stop));
        if (stop && *stop) return {};
        parallel_ranges(last.size(), kSurfelsATask, [&](size_t first, size_t end) {
            for (size_t i = first; i < end; ++i) {
                last[i] = reflected(i);
                light[i].front += last[i].front;
                light[i].back += last[i].back;
            }
        });
    }
    if (settings.only_last) light = std::move(last);
    return {};
}

}  // namespace lucarne::gi
