#include "io/synthetic/scene_geometry.h"

#include <algorithm>
#include <cmath>

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/synthetic/synthetic.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

struct Entry {
    const char* name;
    const char* summary;
    SceneModel (*build)();
};
constexpr std::array kEntries = {
    Entry{"cornell", "the Cornell box, 5.5 m, open in front: a red and a green wall, two blocks",
          build_cornell},
    Entry{"furnace", "a closed cube of 2 m whose albedo is .5 everywhere", build_furnace},
    Entry{"nave",
          "a cathedral nave, 12 x 30 x 15 m: columns, rib vaults, open windows, tiles, coloured cloth",
          build_nave},
    Entry{"two-rooms", "two sealed rooms with an open door and a closed door between them", build_two_rooms},
    Entry{"house", "two rooms with thick walls and a roof: a window, a shut door with an opening above it",
          build_house},
    Entry{"statue", "a smooth closed body on a plinth, seen from outside", build_statue},
    Entry{"ring", "a metal ring of 70 cm that stands on a floor before a wall", build_ring},
    Entry{"paraboloid", "a metal mirror of 1.2 m before a wall, focal length 1.2 m", build_paraboloid},
    Entry{"primitives", "boxes, balls, a cylinder and a cone on a floor of 12 m, seen from outside",
          build_primitives},
    Entry{"loft", "a room of 8 x 5 x 3 m with three windows, open stairs, a gallery and furniture",
          build_loft},
    Entry{"lattice", "a sealed room with thin screens, and a wall at 45 degrees that shuts off a corner",
          build_lattice},
    Entry{"arbour", "a marble bust under beams overgrown with leaves, outdoors", build_arbour},
};

/// A place in a quad, with the weights of its corners.
struct QuadPlace {
    dvec3 position;
    std::array<double, 4> weights{};
};

/// Returns the closest point of the triangle with corners i, j, k. Source: Ericson, Real-Time Collision
/// Detection, 2005, 5.1.5.
QuadPlace closest_in_triangle(const dvec3& p, const std::array<dvec3, 4>& corners, int i, int j, int k) {
    const dvec3 &a = corners[i], &b = corners[j], &c = corners[k];
    const dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const auto place = [&](double wa, double wb, double wc) {
        QuadPlace found{a * wa + b * wb + c * wc};
        found.weights[i] += wa;
        found.weights[j] += wb;
        found.weights[k] += wc;
        return found;
    };
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return place(1, 0, 0);
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return place(0, 1, 0);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return place(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return place(0, 0, 1);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return place(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return place(0, 1 - w, w);
    }
    const double sum = va + vb + vc;
    return place(va / sum, vb / sum, vc / sum);
}

struct ClosestQuery {
    const PatchMesh* mesh;
    dvec3 point;
    double best;  ///< squared distance
    size_t quad = 0;
    QuadPlace place{};
    bool found = false;
};

bool closest_callback(RTCPointQueryFunctionArguments* args) {
    auto& query = *static_cast<ClosestQuery*>(args->userPtr);
    std::array<dvec3, 4> corners;
    for (size_t i = 0; i < 4; ++i) corners[i] = dvec3(query.mesh->corners[4 * args->primID + i]);
    bool nearer = false;
    for (const auto& [i, j, k] : {std::array{0, 1, 3}, std::array{2, 3, 1}}) {
        const QuadPlace place = closest_in_triangle(query.point, corners, i, j, k);
        const dvec3 to = place.position - query.point;
        const double squared = dot(to, to);
        // The lowest quad wins a tie, so that the answer does not depend on the search order.
        if (squared < query.best || (query.found && squared == query.best && args->primID < query.quad)) {
            query.best = squared;
            query.quad = args->primID;
            query.place = place;
            query.found = nearer = true;
        }
    }
    if (nearer) args->query->radius = std::nextafter(static_cast<float>(std::sqrt(query.best)), INFINITY);
    return nearer;
}

}  // namespace

struct SceneGeometry::Embree {
    RTCDevice device;
    RTCScene scene;
    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

const std::vector<SyntheticScene>& synthetic_scenes() {
    static const std::vector<SyntheticScene> kScenes = [] {
        std::vector<SyntheticScene> scenes;
        for (const Entry& entry : kEntries) scenes.push_back({entry.name, entry.summary});
        return scenes;
    }();
    return kScenes;
}

Result<std::shared_ptr<const SceneGeometry>> SceneGeometry::create(const std::string& scene) {
    const auto* entry =
        std::find_if(kEntries.begin(), kEntries.end(), [&](const Entry& e) { return e.name == scene; });
    if (entry == kEntries.end()) {
        std::vector<std::string_view> names;
        for (const Entry& e : kEntries) names.push_back(e.name);
        return bad_arguments(fmt::format("scene '{}'", scene), "there is no such scene",
                             fmt::format("choose one of {}", fmt::join(names, ", ")));
    }
    std::shared_ptr<SceneGeometry> geometry(new SceneGeometry(entry->build()));
    if (!geometry->embree_) return failed("Embree", "it does not start on this machine");
    return geometry;
}

SceneGeometry::SceneGeometry(SceneModel model) : model_(std::move(model)) {
    const PatchMesh& mesh = model_.mesh;
    min_ = max_ = dvec3(mesh.corners.front());
    for (const glm::vec3& corner : mesh.corners) {
        min_ = glm::min(min_, dvec3(corner));
        max_ = glm::max(max_, dvec3(corner));
    }
    // One thread and one instruction set give the same tree, the same rounding and thus the same hits on
    // every machine.
    const RTCDevice device = rtcNewDevice("threads=1,isa=sse4.2");
    if (!device) return;
    const RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry quads = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(quads, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                 RTC_FORMAT_FLOAT3, 12, mesh.corners.size()));
    for (const glm::vec3& corner : mesh.corners)
        for (int axis = 0; axis < 3; ++axis) *vertices++ = corner[axis];
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(quads, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, mesh.quads()));
    for (uint32_t i = 0; i < 4 * mesh.quads(); ++i) indices[i] = i;
    rtcCommitGeometry(quads);
    rtcAttachGeometry(scene, quads);
    rtcReleaseGeometry(quads);
    rtcCommitScene(scene);
    embree_.reset(new Embree{device, scene});
}

SceneGeometry::~SceneGeometry() = default;

std::optional<SurfaceHit> SceneGeometry::cast(const dvec3& origin, const dvec3& direction,
                                              double longest) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin.x);
    ray.ray.org_y = static_cast<float>(origin.y);
    ray.ray.org_z = static_cast<float>(origin.z);
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tfar = static_cast<float>(longest);
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const size_t quad = ray.hit.primID;
    SurfaceHit hit;
    hit.distance = ray.ray.tfar;
    hit.position = origin + direction * hit.distance;
    hit.normal = mesh().normal(quad, ray.hit.u, ray.hit.v);
    // At the rim of a tessellated body the interpolated normal may point away although the face is seen from
    // its front.
    dvec3 face(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
    if (dot(face, hit.normal) < 0) face = -face;
    const double away = dot(hit.normal, direction);
    if (away > 0 && dot(face, direction) < 0) hit.normal = glm::normalize(hit.normal - direction * away);
    hit.finish = mesh().finishes[quad];
    return hit;
}

std::optional<SurfaceHit> SceneGeometry::closest(const dvec3& point, double radius) const {
    ClosestQuery search{&mesh(), point, radius * radius};
    RTCPointQuery query{static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z),
                        0, static_cast<float>(radius)};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(embree_->scene, &query, &context, closest_callback, &search);
    if (!search.found) return std::nullopt;
    SurfaceHit hit;
    hit.distance = std::sqrt(search.best);
    hit.position = search.place.position;
    for (size_t i = 0; i < 4; ++i)
        hit.normal += search.place.weights[i] * dvec3(mesh().normals[4 * search.quad + i]);
    hit.normal = glm::normalize(hit.normal);
    hit.finish = mesh().finishes[search.quad];
    return hit;
}

}  // namespace lucarne::io
