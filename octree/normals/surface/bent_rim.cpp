#include "octree/normals/surface/bent_rim.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

namespace lucarne::octree {
namespace {

/// Distance of a rim point from the mean of its neighbours, in reaches. That of half a disc is .42.
constexpr float kOneSided = 0.25f;
/// Most variance of the heights over the bent surface, in that of those over a plane.
constexpr double kExplained = 0.4;
/// The bend turns the normal by at most 40 degrees: more is another surface.
constexpr double kSteepestBend = 0.84;
constexpr double kLeastDeterminant = 1e-9;
constexpr size_t kUnknowns = 4, kLeastNeighbours = 9;

}  // namespace

std::optional<BentRim> fit_bent_rim(const Patch& nearest, const SurfaceFit& plane) {
    const size_t count = nearest.count;
    if (count < kLeastNeighbours) return std::nullopt;
    const glm::vec3 n = plane.normal;
    const float reach = std::sqrt(nearest.distance2[count - 1]);
    glm::vec3 mean(0.0f);
    for (size_t i = 0; i < count; ++i) mean += nearest.offset(i);
    mean /= static_cast<float>(count);
    mean -= n * glm::dot(n, mean);
    const float aside = glm::length(mean);
    if (!(aside > kOneSided * reach)) return std::nullopt;

    // Heights are c0 + c1 u + c2 v + c3 u^2, with u outward and v along the rim.
    const glm::vec3 out = -mean / aside, along = glm::cross(n, out);
    glm::dmat4 products(0.0);
    glm::dvec4 sums(0.0);
    double squares = 0, first = 0;
    for (size_t i = 0; i < count; ++i) {
        const glm::vec3 p = nearest.offset(i) / reach;
        const double u = glm::dot(out, p), v = glm::dot(along, p), h = glm::dot(n, p);
        const glm::dvec4 terms(1, u, v, u * u);
        products += glm::outerProduct(terms, terms);
        sums += terms * h;
        squares += h * h;
        first += h;
    }
    const double all = static_cast<double>(count);
    if (!(std::abs(glm::determinant(products / all)) > kLeastDeterminant)) return std::nullopt;
    const glm::dvec4 bend = glm::inverse(products) * sums;
    const double left = std::max(0.0, squares - glm::dot(bend, sums)) / (all - kUnknowns);
    const double flat = (squares - first * first / all) / (all - kUnknowns + 1);
    const double most = std::min(flat, double{plane.variance} / (double{reach} * double{reach}));
    if (!(left < kExplained * most) || std::hypot(bend[1], bend[2]) > kSteepestBend) return std::nullopt;

    BentRim rim;
    rim.normal = glm::normalize(n - out * static_cast<float>(bend[1]) - along * static_cast<float>(bend[2]));
    rim.variance = static_cast<float>(left) * reach * reach;
    for (size_t i = 0; i < count; ++i) {
        const float height = glm::dot(rim.normal, nearest.offset(i));
        rim.layer = {std::min(rim.layer.low, height), std::max(rim.layer.high, height)};
    }
    return rim;
}

}  // namespace lucarne::octree
