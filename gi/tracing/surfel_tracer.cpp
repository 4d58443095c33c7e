#include "gi/tracing/surfel_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <embree3/rtcore.h>
#include <glm/geometric.hpp>

#include "gi/shared/edge.h"
#include "io/core/parallel.h"

namespace lucarne::gi::tracing {
namespace {

RTCRay make_ray(const glm::vec3& origin, const glm::vec3& direction, float length) {
    RTCRay ray{};
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.tnear = 0;
    ray.tfar = length;
    ray.mask = ~0u;
    return ray;
}

}  // namespace

bool has_disc(const Surfel& s) {
    const auto finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    return s.radius > 0 && std::isfinite(s.radius) && finite(s.position) && finite(s.normal) &&
           glm::dot(s.normal, s.normal) > 0.5f;
}

namespace {

/// Which discs end at lines: few do, and their bits stay in a cache, which surfels do not.
struct Edges {
    const std::vector<Surfel>& surfels;
    std::vector<bool> has;  ///< of each surfel
};

/// Rejects the hits of a ray beyond the lines of the surfels' discs.
void reject_beyond_edges(const RTCFilterFunctionNArguments* found) {
    const auto& edges = *static_cast<const Edges*>(found->geometryUserPtr);
    for (unsigned i = 0; i < found->N; ++i) {
        if (!found->valid[i]) continue;
        const unsigned number = RTCHitN_primID(found->hit, found->N, i);
        if (!edges.has[number]) continue;
        const Surfel& surfel = edges.surfels[number];
        const glm::vec3 origin(RTCRayN_org_x(found->ray, found->N, i), RTCRayN_org_y(found->ray, found->N, i),
                               RTCRayN_org_z(found->ray, found->N, i)),
            direction(RTCRayN_dir_x(found->ray, found->N, i), RTCRayN_dir_y(found->ray, found->N, i),
                      RTCRayN_dir_z(found->ray, found->N, i));
        const glm::vec3 offset = origin - surfel.position + direction * RTCRayN_tfar(found->ray, found->N, i);
        if (!within_edge(surfel.edge, offset)) found->valid[i] = 0;
    }
}

}  // namespace

struct SurfelTracer::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::optional<Edges> edges;  ///< none: no disc ends at a line

    ~Embree() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

SurfelTracer::SurfelTracer() : embree_(std::make_unique<Embree>()) {}
SurfelTracer::~SurfelTracer() = default;

Result<std::unique_ptr<SurfelTracer>> SurfelTracer::create(std::vector<Surfel> surfels) {
    std::unique_ptr<SurfelTracer> tracer(new SurfelTracer);
    std::erase_if(surfels, [](const Surfel& s) { return !has_disc(s); });
    tracer->surfels_ = std::move(surfels);
    const size_t count = tracer->surfels_.size();
    auto& embree = *tracer->embree_;
    embree.device = rtcNewDevice(nullptr);
    if (!embree.device) return failed("rays", "Embree does not start on this machine");
    embree.scene = rtcNewScene(embree.device);
    rtcSetSceneFlags(embree.scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);  // for each_crossed()
    // No compact or robust flags: robust ones only concern triangles, and discs are planes with a radius.
    if (count > 0) {
        const RTCGeometry discs = rtcNewGeometry(embree.device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
        auto* places = static_cast<float*>(rtcSetNewGeometryBuffer(
            discs, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), count));
        auto* normals = static_cast<float*>(rtcSetNewGeometryBuffer(
            discs, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
        if (places && normals) {
            parallel_ranges(count, 65536, [&](size_t first, size_t last) {
                for (size_t i = first; i < last; ++i) {
                    const Surfel& s = tracer->surfels_[i];
                    const float place[4] = {s.position.x, s.position.y, s.position.z, s.radius};
                    std::copy_n(place, 4, places + 4 * i);
                    const float normal[3] = {s.normal.x, s.normal.y, s.normal.z};
                    std::copy_n(normal, 3, normals + 3 * i);
                }
            });
            if (std::ranges::any_of(tracer->surfels_,
                                    [](const Surfel& s) { return s.edge != glm::vec3(0.0f); })) {
                embree.edges.emplace(Edges{tracer->surfels_, {}});
                for (const Surfel& s : tracer->surfels_)
                    embree.edges->has.push_back(s.edge != glm::vec3(0.0f));
                rtcSetGeometryUserData(discs, &*embree.edges);
                rtcSetGeometryIntersectFilterFunction(discs, reject_beyond_edges);
                rtcSetGeometryOccludedFilterFunction(discs, reject_beyond_edges);
            }
            rtcCommitGeometry(discs);
            rtcAttachGeometry(embree.scene, discs);
        }
        rtcReleaseGeometry(discs);
    }
    rtcCommitScene(embree.scene);
    if (rtcGetDeviceError(embree.device) != RTC_ERROR_NONE)
        return failed("rays", "Embree cannot build its tree over the surfels (out of memory?)",
                      "lower --points");
    return tracer;
}

std::optional<SurfelTracer::Hit> SurfelTracer::first_hit(const glm::vec3& origin,
                                                         const glm::vec3& direction) const {
    RTCRayHit query{};
    query.ray = make_ray(origin, direction, std::numeric_limits<float>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const glm::vec3 normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
    return Hit{query.hit.primID, query.ray.tfar, glm::dot(direction, normal) > 0};
}

std::optional<uint32_t> SurfelTracer::nearest(const glm::vec3& origin, const glm::vec3& direction) const {
    const auto hit = first_hit(origin, direction);
    return hit ? std::optional(hit->surfel) : std::nullopt;
}

namespace {

bool any_hit(RTCScene scene, RTCRay ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
    return ray.tfar < 0;  // Embree sets it to -infinity on a hit
}

/// Cosine between a point's normal and that of a disc over it which is another layer of the same surface.
constexpr float kSameSheet = 0.8f;

}  // namespace

bool SurfelTracer::occluded(const glm::vec3& from, const glm::vec3& to) const {
    return any_hit(embree_->scene, make_ray(from, to - from, 1.0f - 1e-5f));
}

bool SurfelTracer::occluded_along(const glm::vec3& origin, const glm::vec3& direction) const {
    return any_hit(embree_->scene, make_ray(origin, direction, std::numeric_limits<float>::infinity()));
}

void SurfelTracer::each_crossed(const glm::vec3& origin, const glm::vec3& direction, float begin, float end,
                                const std::function<void(uint32_t)>& visit) const {
    struct Context : RTCIntersectContext {
        const std::function<void(uint32_t)>* visit;
    } context;
    rtcInitIntersectContext(&context);
    context.visit = &visit;
    context.filter = [](const RTCFilterFunctionNArguments* found) {
        (*static_cast<const Context*>(found->context)->visit)(RTCHitN_primID(found->hit, found->N, 0));
        found->valid[0] = 0;  // reject the hit, so that the ray continues
    };
    RTCRay ray = make_ray(origin, direction, end);
    ray.tnear = begin;
    rtcOccluded1(embree_->scene, &context, &ray);
}

double SurfelTracer::coverage() const {
    double discs = 0, surface = 0;
    for (const Surfel& s : surfels_) {
        discs += M_PI * s.radius * s.radius;
        surface += s.area;
    }
    return surface > 0 ? discs / surface : 0;
}

glm::vec3 offset_origin(const glm::vec3& position, const glm::vec3& normal, float radius) {
    // 1e-6 of the largest coordinate is some eight float steps; below that Embree's rounding decides.
    const float largest = std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
    return position + normal * std::max(kOriginOffset * radius, 1e-6f * largest);
}

glm::vec3 before_what_hides(const SurfelTracer& surfels, const glm::vec3& origin, const glm::vec3& viewer,
                            const glm::vec3& normal, float radius) {
    // The start in front of the surface that is met in a direction, if it is no other object in front of the
    // point.
    const auto before = [&](const glm::vec3& direction, float least_cosine,
                            float most_radii) -> std::optional<glm::vec3> {
        const auto hit = surfels.nearest(origin, direction);
        if (!hit) return std::nullopt;
        const Surfel& surfel = surfels.surfels()[*hit];
        const float side = glm::dot(surfel.normal, direction);
        if (std::abs(side) <= least_cosine) return std::nullopt;
        const float distance = glm::dot(surfel.normal, surfel.position - origin) / side;
        if (distance > most_radii * std::max(radius, surfel.radius)) return std::nullopt;
        return offset_origin(origin + direction * distance, side > 0 ? surfel.normal : -surfel.normal,
                             surfel.radius);
    };
    if (const auto start = before(viewer, 0, 2)) return *start;
    // Steps and ledges of coarse scans are parallel, too, and lie farther apart than layers of one surface.
    return before(normal, kSameSheet, 0.5f).value_or(origin);
}

}  // namespace lucarne::gi::tracing
