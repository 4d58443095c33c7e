#include "octree/normals/surface/plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

struct Covariance {
    double xx, yy, zz, xy, xz, yz;
};

/// The smallest root of the characteristic polynomial l^3 - trace l^2 + minors l - det, whose roots are all
/// real and none negative: left of it the polynomial is concave and rises, so that Newton's steps from 0
/// never go beyond it, and for a plane, whose least variance is small, two or three do.
double least_eigenvalue(double trace, double minors, double determinant) {
    constexpr int kMostSteps = 40;  // at a triple root each step goes a third of the way
    double root = 0;
    for (int i = 0; i < kMostSteps; ++i) {
        const double value = ((root - trace) * root + minors) * root - determinant,
                     slope = (3 * root - 2 * trace) * root + minors;
        if (!(value < 0) || !(slope > 0)) break;
        const double step = -value / slope;
        root += step;
        if (step <= 1e-9 * root) break;
    }
    return root;
}

/// The direction that all rows of the matrix less its eigenvalue are perpendicular to.
glm::dvec3 eigenvector(const Covariance& c, double eigenvalue) {
    const glm::dvec3 x(c.xx - eigenvalue, c.xy, c.xz), y(c.xy, c.yy - eigenvalue, c.yz),
        z(c.xz, c.yz, c.zz - eigenvalue);
    const glm::dvec3 a = glm::cross(x, y), b = glm::cross(x, z), d = glm::cross(y, z);
    const double aa = glm::dot(a, a), bb = glm::dot(b, b), dd = glm::dot(d, d);
    const glm::dvec3& longest = aa >= bb && aa >= dd ? a : bb >= dd ? b : d;
    const double length2 = std::max({aa, bb, dd});
    return length2 > 0 ? longest / std::sqrt(length2) : glm::dvec3(0, 0, 1);
}

}  // namespace

Plane plane_of(const Moments& moments) {
    const double n = static_cast<double>(moments.count);
    const double x = moments.sum[0] / n, y = moments.sum[1] / n, z = moments.sum[2] / n;
    const auto product = [&](size_t i) { return static_cast<double>(moments.products[i]) / n; };
    Covariance c{product(0) - x * x, product(1) - y * y, product(2) - z * z,
                 product(3) - x * y, product(4) - x * z, product(5) - y * z};
    const double scale = c.xx + c.yy + c.zz;
    if (!(scale > std::numeric_limits<double>::min())) return {{0, 0, 1}, {0, 0, 0}};
    for (double* entry : {&c.xx, &c.yy, &c.zz, &c.xy, &c.xz, &c.yz}) *entry /= scale;

    const double minors = c.xx * c.yy + c.xx * c.zz + c.yy * c.zz - c.xy * c.xy - c.xz * c.xz - c.yz * c.yz;
    const double determinant = c.xx * (c.yy * c.zz - c.yz * c.yz) - c.xy * (c.xy * c.zz - c.yz * c.xz) +
                               c.xz * (c.xy * c.yz - c.yy * c.xz);
    const double least = least_eigenvalue(1, minors, determinant);
    // The other two follow from the trace and the sum of the principal minors.
    const double sum = std::max(0.0, 1 - least), rest = minors - least * sum;
    const double largest = sum / 2 + std::sqrt(std::max(0.0, sum * sum / 4 - rest));
    const double middle = std::clamp(sum - largest, least, std::max(least, largest));
    return {eigenvector(c, least), {least * scale, middle * scale, largest * scale}};
}

Plane fit_plane(NeighbourSearch search, const Patch& patch) {
    return search == NeighbourSearch::flann ? pcl_plane(patch) : plane_of(moments_of(patch));
}

}  // namespace lucarne::octree
