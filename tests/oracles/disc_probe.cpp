// Prints which discs of a cache the rays through pixels of its first view meet, to find why a pixel is wrong:
//   disc_probe CACHE MOOD WIDTHxHEIGHT [SCENE|-] [X,Y ...]
//   disc_probe CACHE MOOD WIDTHxHEIGHT SCENE --map GBUFFER.exr MAP.png
//   disc_probe CACHE MOOD WIDTHxHEIGHT SCENE --kinds GBUFFER.exr
// With the name of the virtual scene that was scanned (`lucarne generate`) each disc is compared with the
// true surface. Discs are at full detail; a picture may draw fewer and larger ones. --map compares the output
// of `lucarne render --gbuffer` with it, and draws what is wrong: blue: no surfel; red: nearer; yellow:
// farther than the truth; green: normals off by more than 10 degrees. --kinds prints which discs make the
// pixels that are nearer than the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "gi/scene/views.h"
#include "gi/shared/disc.h"
#include "io/core/parallel.h"
#include "io/image/image.h"
#include "tests/bench/all_surfels.h"
#include "tests/bench/true_surface.h"
#include "viewer/commands/options/drawing_options.h"

namespace lucarne {
namespace {

/// A disc that the ray through a pixel meets.
struct Met {
    const gi::Surfel* surfel = nullptr;
    float depth = 0;
    float off = 0;        ///< of the ray from the centre, radii
    bool beyond = false;  ///< beyond the disc's line
    bool centre = false;  ///< the ray misses the disc, but its centre lies in the pixel
};

std::vector<Met> discs_at(const std::vector<gi::Surfel>& surfels, const gi::CameraView& view,
                          const glm::vec2& at) {
    std::vector<Met> found;
    const glm::vec3 start = gi::view_start(view, at), ray = gi::view_ray(view, at);
    const float pixel = 2 * glm::length(glm::vec3(view.up)) / static_cast<float>(view.height);
    for (const gi::Surfel& s : surfels) {
        if (!(s.radius > 0)) continue;
        const glm::vec3 centre = s.position - start;
        const float depth = glm::dot(centre, glm::vec3(view.forward));
        if (depth <= 0) continue;
        const float beside = glm::length(centre - ray * depth);
        if (beside > s.radius * 4 + pixel * depth) continue;
        const glm::vec3 normal = s.normal == glm::vec3(0.0f) ? -glm::normalize(ray) : s.normal;
        const gi::DiscHit hit = gi::meet_disc(centre, normal, ray);
        const bool inside = hit.t > 0 && gi::on_disc(hit, s.radius);
        const bool home = beside < .7f * pixel * depth;
        if (!inside && !home) continue;
        found.push_back({&s, inside ? hit.t : depth, std::sqrt(hit.distance2) / s.radius,
                         !gi::within_edge(s.edge, hit.offset), !inside});
    }
    std::sort(found.begin(), found.end(), [](const Met& a, const Met& b) { return a.depth < b.depth; });
    return found;
}

void print(const Met& met, const glm::vec3& ray, const bench::NearestSurface* surface) {
    constexpr float kDegrees = 180 / static_cast<float>(M_PI);
    const gi::Surfel& s = *met.surfel;
    std::string line = fmt::format("  {:8.4f} m{} at {:9.4f} {:9.4f} {:9.4f} radius {:.4f}", met.depth,
                                   met.centre   ? "*"
                                   : met.beyond ? "|"
                                                : " ",
                                   s.position.x, s.position.y, s.position.z, s.radius);
    if (s.normal == glm::vec3(0.0f))
        line += " no normal             ";
    else
        line += fmt::format(" n {:5.2f} {:5.2f} {:5.2f} {:3.0f} deg", s.normal.x, s.normal.y, s.normal.z,
                            std::acos(glm::dot(s.normal, -glm::normalize(ray))) * kDegrees);
    line += fmt::format(" off {:4.2f}", met.off);
    const float edge = glm::length(s.edge);
    if (edge > 0)
        line += fmt::format(" line {:4.2f} at {:5.2f} {:5.2f} {:5.2f}", 1 / edge / s.radius, s.edge.x / edge,
                            s.edge.y / edge, s.edge.z / edge);
    line += fmt::format(" colour {:.2f} {:.2f} {:.2f}", s.albedo.x, s.albedo.y, s.albedo.z);
    if (surface) {
        const bench::DiscFit fit = surface->fit(s.position, s.normal, s.radius, s.edge);
        line += fmt::format("; truth {:5.1f} mm, {:4.1f} deg, outside {:3.0f} %", 1000 * fit.distance,
                            fit.angle, 100 * fit.outside);
    }
    std::printf("%s\n", line.c_str());
}

/// Whether a normal is that of the true face in a pixel. The normals of the truth are interpolated between
/// the corners of a mesh, and those of a tall face beside a moulding lean toward the moulding.
bool is_normal_of_face(const io::SceneGeometry& geometry, const gi::CameraView& view, const glm::vec2& at,
                       const glm::dvec3& normal) {
    std::array<glm::dvec3, 3> places;
    for (size_t i = 0; i < 3; ++i) {
        const glm::vec2 offset(i == 1 ? .05f : 0, i == 2 ? .05f : 0);
        const glm::dvec3 ray(gi::view_ray(view, at + offset));
        const auto hit = geometry.cast(glm::dvec3(view.origin), glm::normalize(ray));
        if (!hit) return false;
        places[i] = hit->position;
    }
    const glm::dvec3 face = glm::cross(places[1] - places[0], places[2] - places[0]);
    return bench::plane_angle(glm::normalize(face), normal) <= bench::kBentDegrees;
}

/// Draws why pixels differ from the true surface, and prints their shares.
Result<void> draw_map(const io::SceneGeometry& geometry, const gi::SceneCamera& camera, ImageSize size,
                      const char* gbuffer, const char* map) {
    constexpr uint8_t kColours[][3] = {{0, 60, 255}, {255, 0, 0}, {255, 220, 0}, {0, 200, 0}, {40, 40, 40}};
    const bench::TrueView truth(geometry, camera, size, 0);
    const gi::CameraView view = gi::camera_view(camera, size, {});
    LUCARNE_ASSIGN(const io::Image seen, io::read_exr(gbuffer));
    io::Image8 picture{size.width, size.height, {}};
    std::array<double, bench::kCauses.size()> counts{};
    if (seen.width != size.width || seen.height != size.height) return failed(gbuffer, "has another size");
    for (size_t i = 0; i < seen.pixels.size(); ++i) {
        bench::Cause found = truth.cause(i, seen.pixels[i]);
        const glm::vec2 at(static_cast<float>(i % size.width) + .5f,
                           static_cast<float>(i / size.width) + .5f);
        if (found == bench::Cause::bent && is_normal_of_face(geometry, view, at, glm::dvec3(seen.pixels[i])))
            found = bench::Cause::good;
        const auto cause = static_cast<size_t>(found);
        counts[cause] += 100.0 / static_cast<double>(seen.pixels.size());
        picture.bytes.insert(picture.bytes.end(), std::begin(kColours[cause]), std::end(kColours[cause]));
    }
    for (size_t i = 0; i < counts.size(); ++i)
        std::printf("%-24s %6.3f %%\n", bench::kCauses[i].second, counts[i]);
    return io::write_png(map, picture, true);
}

/// What is wrong with the disc that a pixel shows although it is nearer than the truth.
enum class Kind {
    none,
    air,
    tilted_crease,
    tilted,
    line_crease,
    line_border,
    overhang_crease,
    overhang,
    counted
};
constexpr std::array<const char*, size_t(Kind::counted)> kKinds = {"no disc at full detail",
                                                                   "in the air",
                                                                   "tilted, at a crease",
                                                                   "tilted elsewhere",
                                                                   "reaches over, line at a crease",
                                                                   "reaches over, line elsewhere",
                                                                   "reaches over, no line, at a crease",
                                                                   "reaches over, no line"};

Kind kind_of(const Met& met, const bench::DiscFit& fit) {
    if (fit.distance > bench::kOtherSurface) return Kind::air;
    if (fit.angle > bench::kBentDegrees) return fit.at_crease ? Kind::tilted_crease : Kind::tilted;
    if (glm::length(met.surfel->edge) > 0) return fit.at_crease ? Kind::line_crease : Kind::line_border;
    return fit.at_crease ? Kind::overhang_crease : Kind::overhang;
}

/// Prints which discs make the pixels that are nearer than the truth, judged by some of these pixels.
Result<void> print_kinds(const io::SceneGeometry& geometry, const gi::SceneCamera& camera, ImageSize size,
                         const char* gbuffer, const std::vector<gi::Surfel>& surfels) {
    constexpr size_t kPixels = 1500;
    struct Sum {
        double count = 0, angle = 0, off = 0, radius = 0, over = 0, line = 0, pixels = 0;
    };
    const bench::TrueView truth(geometry, camera, size, 0);
    const gi::CameraView view = gi::camera_view(camera, size, {});
    const bench::NearestSurface surface(geometry);
    LUCARNE_ASSIGN(const io::Image seen, io::read_exr(gbuffer));
    if (seen.width != size.width || seen.height != size.height) return failed(gbuffer, "has another size");
    std::vector<size_t> nearer;
    for (size_t i = 0; i < seen.pixels.size(); ++i)
        if (truth.cause(i, seen.pixels[i]) == bench::Cause::nearer) nearer.push_back(i);
    const size_t used = std::min(nearer.size(), kPixels);
    std::vector<std::pair<Kind, Sum>> found(used);
    parallel_ranges(used, 8, [&](size_t first, size_t last) {
        for (size_t n = first; n < last; ++n) {
            const size_t i = nearer[n * nearer.size() / used];
            const glm::vec2 at(static_cast<float>(i % size.width) + .5f,
                               static_cast<float>(i / size.width) + .5f);
            const auto met = discs_at(surfels, view, at);
            const auto shown = std::find_if(met.begin(), met.end(), [&](const Met& m) {
                return !m.beyond && !m.centre && m.depth > .99f * seen.pixels[i].w - .02f;
            });
            if (shown == met.end()) continue;
            const gi::Surfel& s = *shown->surfel;
            const bench::DiscFit fit = surface.fit(s.position, s.normal, s.radius, s.edge);
            const float edge = glm::length(s.edge);
            const double pixel =
                2 * glm::length(glm::dvec3(glm::vec3(view.up))) * double{shown->depth} / view.height;
            found[n] = {kind_of(*shown, fit),
                        {1, fit.angle, double{shown->off}, double{s.radius},
                         surface.distance(
                             glm::dvec3(gi::view_start(view, at) + gi::view_ray(view, at) * shown->depth)) /
                             pixel,
                         edge > 0 ? 1 / double{edge * s.radius} : 0.0, double{s.radius} / pixel}};
        }
    });
    std::printf("%zu pixels are nearer than the truth; of %zu of them:\n", nearer.size(), used);
    for (size_t k = 0; k < kKinds.size(); ++k) {
        Sum sum;
        std::vector<double> over;
        for (const auto& [kind, one] : found) {
            if (static_cast<size_t>(kind) != k) continue;
            sum.count += 1, sum.angle += one.angle, sum.off += one.off, sum.radius += one.radius;
            sum.line += one.line, sum.pixels += one.pixels;
            over.push_back(one.over);
        }
        std::sort(over.begin(), over.end());
        const double n = std::max(1.0, sum.count);
        std::printf(
            "%-36s %5.1f %%: %4.1f deg, met at %.2f radii, line at %.2f; radius %.3f m, %4.1f pixels; "
            "%.1f and %.1f pixels (p50, p90) off the surface\n",
            kKinds[k], 100 * sum.count / static_cast<double>(std::max<size_t>(1, used)), sum.angle / n,
            sum.off / n, sum.line / n, sum.radius / n, sum.pixels / n,
            over.empty() ? 0.0 : over[over.size() / 2], over.empty() ? 0.0 : over[over.size() * 9 / 10]);
    }
    return {};
}

Result<void> probe(int count, char** arguments) {
    viewer::DrawingOptions options;
    options.mood = arguments[2];
    options.size = arguments[3];
    LUCARNE_TRY(viewer::take_render_settings(options));
    LUCARNE_ASSIGN(const viewer::Drawing drawing, viewer::resolve(options));
    LUCARNE_ASSIGN(const auto source, viewer::open_input(arguments[1]));
    LUCARNE_ASSIGN(const viewer::SceneForScan loaded, viewer::load_scene_for(options, *source));
    LUCARNE_ASSIGN(const gi::SceneCamera camera, viewer::find_camera(loaded.scene, ""));
    std::printf("camera at %.4f %.4f %.4f, target %.4f %.4f %.4f, fov %.2f degrees\n", camera.position.x,
                camera.position.y, camera.position.z, camera.target.x, camera.target.y, camera.target.z,
                camera.vertical_fov * 180 / M_PI);
    std::shared_ptr<const io::SceneGeometry> geometry;
    if (count > 4 && std::string(arguments[4]) != "-") {
        LUCARNE_ASSIGN(geometry, io::SceneGeometry::create(arguments[4]));
    }
    if (geometry && count == 8 && std::string(arguments[5]) == "--map")
        return draw_map(*geometry, camera, drawing.size, arguments[6], arguments[7]);
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto surfels, bench::all_surfels(*device, arguments[1]));
    if (geometry && count == 7 && std::string(arguments[5]) == "--kinds")
        return print_kinds(*geometry, camera, drawing.size, arguments[6], surfels);
    const gi::CameraView view = gi::camera_view(camera, drawing.size, {});
    std::optional<bench::NearestSurface> surface;
    if (geometry) surface.emplace(*geometry);
    for (int i = 5; i < count; ++i) {
        float x = 0, y = 0;
        if (std::sscanf(arguments[i], "%f,%f", &x, &y) != 2) return bad_arguments(arguments[i], "is no X,Y");
        const glm::vec2 at(x + .5f, y + .5f);
        std::printf("pixel %g,%g", x, y);
        if (geometry) {
            const glm::dvec3 ray(gi::view_ray(view, at));
            const auto hit = geometry->cast(glm::dvec3(view.origin), glm::normalize(ray));
            if (hit)
                std::printf(": truth at %.4f m, n %.2f %.2f %.2f, at %.3f %.3f %.3f",
                            hit->distance / glm::length(ray), hit->normal.x, hit->normal.y, hit->normal.z,
                            hit->position.x, hit->position.y, hit->position.z);
        }
        std::printf("\n");
        const auto met = discs_at(surfels, view, at);
        for (size_t m = 0; m < std::min<size_t>(met.size(), 14); ++m)
            print(met[m], gi::view_ray(view, at), surface ? &*surface : nullptr);
    }
    return {};
}

}  // namespace
}  // namespace lucarne

int main(int count, char** arguments) {
    if (count < 4) {
        std::fprintf(stderr, "usage: disc_probe CACHE MOOD WIDTHxHEIGHT [SCENE|-] [X,Y ...]\n");
        return 2;
    }
    const auto done = lucarne::probe(count, arguments);
    if (!done) std::fprintf(stderr, "%s\n", done.error().line().c_str());
    return done ? 0 : static_cast<int>(done.error().kind);
}
