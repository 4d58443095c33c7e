#include <algorithm>
#include <cmath>

#include <pcl/common/centroid.h>
#include <pcl/common/eigen.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "octree/normals/surface/plane.h"

namespace lucarne::octree {

Plane pcl_plane(const Patch& patch) {
    pcl::PointCloud<pcl::PointXYZ> cloud;
    cloud.resize(patch.count);
    for (size_t i = 0; i < patch.count; ++i) cloud[i] = pcl::PointXYZ(patch.x[i], patch.y[i], patch.z[i]);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    Eigen::Vector4d centroid = Eigen::Vector4d::Zero();
    pcl::computeMeanAndCovarianceMatrix(cloud, covariance, centroid);

    // PCL's solver gives the least eigenvalue and its vector; the other two follow from the trace and the sum
    // of the principal minors, which spares a second solution of the cubic.
    double least = 0;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    pcl::eigen33(covariance, least, axis);
    least = std::max(least, 0.0);
    const double sum = std::max(0.0, covariance.trace() - least);
    const double minors = covariance(0, 0) * covariance(1, 1) + covariance(0, 0) * covariance(2, 2) +
                          covariance(1, 1) * covariance(2, 2) - covariance(0, 1) * covariance(0, 1) -
                          covariance(0, 2) * covariance(0, 2) - covariance(1, 2) * covariance(1, 2);
    const double product = minors - least * sum;
    const double largest = sum / 2 + std::sqrt(std::max(0.0, sum * sum / 4 - product));
    const double middle = std::clamp(sum - largest, least, std::max(least, largest));
    return {{axis.x(), axis.y(), axis.z()}, {least, middle, largest}};
}

}  // namespace lucarne::octree
