#include <algorithm>
#include <cmath>
#include <limits>

#include <pcl/common/eigen.h>

#include "octree/normals/surface/plane.h"

namespace lucarne::octree {

Plane plane_of(const Moments& moments) {
    const double n = static_cast<double>(moments.count);
    const double x = moments.sum[0] / n, y = moments.sum[1] / n, z = moments.sum[2] / n;
    const auto product = [&](size_t i) { return static_cast<double>(moments.products[i]) / n; };
    const double xx = product(0) - x * x, yy = product(1) - y * y, zz = product(2) - z * z,
                 xy = product(3) - x * y, xz = product(4) - x * z, yz = product(5) - y * z;
    const double trace = xx + yy + zz;
    if (!(trace > std::numeric_limits<double>::min())) return {{0, 0, 1}, {0, 0, 0}};

    Eigen::Matrix3d covariance;
    covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    covariance /= trace;
    double least = 0;
    Eigen::Vector3d axis;
    pcl::eigen33(covariance, least, axis);
    // PCL gives the least eigenvalue and its vector. The other two follow from the trace, which is 1, and the
    // sum of the principal minors. This saves solving the cubic equation again.
    least = std::max(least, 0.0);
    const double minors = (xx * yy + xx * zz + yy * zz - xy * xy - xz * xz - yz * yz) / (trace * trace);
    const double sum = std::max(0.0, 1 - least), rest = minors - least * sum;
    const double largest = sum / 2 + std::sqrt(std::max(0.0, sum * sum / 4 - rest));
    const double middle = std::clamp(sum - largest, least, std::max(least, largest));
    return {{axis.x(), axis.y(), axis.z()}, {least * trace, middle * trace, largest * trace}};
}

}  // namespace lucarne::octree
