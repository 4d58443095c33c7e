#include "gi/gather/vpls.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "gi/gather/light_sources.h"
#include "gi/shared/disc_form_factor.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/lobe.h"
#include "gi/tracing/exposure.h"
#include "gi/tracing/surfel_sampler.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kPlacesATask = 4096;
/// So many places tell the flux of all light to half a per cent where discs have 7 times the area of the
/// surface, as in scans.
constexpr uint64_t kDrawnPlaces = 1 << 19;

/// Returns the radiance of a VPL toward a point at `offset` from it. A lobe is seen from all over the disc,
/// so it is wider for near points.
glm::vec3 radiance(const VirtualLight& vpl, const glm::vec3& offset) {
    const float size2 = glm::dot(vpl.directions, vpl.directions);
    if (!(size2 > 0)) return vpl.even;
    const float distance2 = glm::dot(offset, offset);
    const float narrower = std::sqrt(distance2 / (distance2 + vpl.radius2));
    return vpl.lobe * lobe_radiance(vpl.lobe, vpl.directions * narrower, offset / std::sqrt(distance2));
}

/// Returns a VPL at the light of a source; `exitance` and `flux` are the mean of three colours, W/m^2 and W.
VirtualLight vpl_at(const LightSource& source, const Surfel& surfel, const glm::vec3& position,
                    std::span<const SideLight> light, const SideLobes& lobes, double exitance, double flux) {
    const auto side = [&](const SideLight& both) { return source.back ? both.back : both.front; };
    VirtualLight vpl{};
    vpl.position = position;
    vpl.normal = side({surfel.normal, -surfel.normal});
    vpl.origin = tracing::offset_origin(position, vpl.normal, surfel.radius);
    vpl.radius2 = static_cast<float>(flux / (exitance * kPi));
    if (source.specular) {
        vpl.lobe = side(lobes.light[source.surfel]);
        vpl.directions = side(lobes.directions[source.surfel]);
    } else {
        vpl.even = side(light[source.surfel]);
    }
    return vpl;
}

/// A place where light leaves.
struct Place {
    LightSource source{};
    glm::vec3 position{};
};

/// Returns places in proportion to the light that leaves them, in the order of the tree. They are drawn on
/// all discs, which overlap, and kept where nothing covers them: light leaves there alone.
std::vector<Place> lit_places(const tracing::SurfelTracer& tracer, const LightSources& sources,
                              uint64_t seed) {
    std::vector<std::optional<Place>> drawn(kDrawnPlaces);
    parallel_ranges(drawn.size(), kPlacesATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            Random random(seed, i);
            const double share = (static_cast<double>(i) + random.uniform()) / kDrawnPlaces;
            const LightSource source = sources.at(share);
            const Surfel& surfel = tracer.surfels()[source.traced];
            const glm::vec3 normal = source.back ? -surfel.normal : surfel.normal;
            const glm::vec3 position = tracing::point_on_disc(surfel, random);
            if (tracing::is_exposed(tracer, source.traced, position, normal))
                drawn[i] = Place{source, position};
        }
    });
    std::vector<Place> places;
    for (const std::optional<Place>& place : drawn)
        if (place) places.push_back(*place);
    return places;
}

}  // namespace

std::vector<VirtualLight> place_vpls(const TracedTree& traced, std::span<const SideLight> light,
                                     const SideLobes& lobes, uint64_t count, uint64_t seed) {
    const std::vector<Surfel>& surfels = traced.tracer->surfels();
    std::vector<float> areas;
    areas.reserve(2 * surfels.size());
    for (const Surfel& surfel : surfels) areas.insert(areas.end(), 2, kPi * surfel.radius * surfel.radius);
    const LightSources sources(traced.surfel_of, areas, light, lobes);
    if (!(sources.total() > 0)) return {};
    const std::vector<Place> places = lit_places(*traced.tracer, sources, seed);
    const double all = static_cast<double>(places.size());
    const double flux = sources.total() * all / kDrawnPlaces;
    count = std::min<uint64_t>(count, places.size());
    Random random(seed, kDrawnPlaces);
    std::vector<VirtualLight> vpls;
    vpls.reserve(count);
    for (uint64_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
        const Place& place = places[std::min(static_cast<size_t>(share * all), places.size() - 1)];
        vpls.push_back(vpl_at(place.source, surfels[place.source.traced], place.position, light, lobes,
                              mean_colour(sources.exitance(place.source)),
                              flux / static_cast<double>(count)));
    }
    return vpls;
}

glm::vec3 irradiance_by(const VirtualLight& vpl, const glm::vec3& position, const glm::vec3& normal,
                        float radius) {
    const glm::vec3 offset = position - vpl.position;
    const float height = std::min(-glm::dot(normal, offset), glm::dot(vpl.normal, offset));
    if (!(height > kRimPush * radius)) return glm::vec3(0.0f);
    return radiance(vpl, offset) * disc_form_factor(normal, vpl.normal, offset, vpl.radius2);
}

}  // namespace lucarne::gi
