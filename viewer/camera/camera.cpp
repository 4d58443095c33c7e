#include "viewer/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kSteepest = std::numbers::pi / 2 - 1e-5;
constexpr double kNearestDepth = 1e-6;  ///< least depth of the pivot as a share of its distance, so that
                                        ///< panning works with the pivot behind the camera

}  // namespace

CameraRig::CameraRig(const gi::SceneCamera& camera)
    : position_(camera.position),
      pivot_(camera.target),
      vertical_fov_(camera.vertical_fov),
      height_(camera.orthographic_height) {
    const glm::dvec3 ahead = camera.target - camera.position;
    yaw_ = ahead.x == 0 && ahead.y == 0 ? std::numbers::pi / 2 : std::atan2(ahead.y, ahead.x);
    pitch_ = std::clamp(std::atan2(ahead.z, std::hypot(ahead.x, ahead.y)), -kSteepest, kSteepest);
}

gi::SceneCamera CameraRig::camera() const {
    gi::SceneCamera camera;
    camera.position = position_;
    camera.target = position_ + forward() * std::max(glm::distance(pivot_, position_), 1e-3);
    camera.vertical_fov = vertical_fov_;
    if (orthographic()) {
        const double back = std::max(0.0, clearance_ - glm::dot(pivot_ - position_, forward()));
        camera.position -= forward() * back;
        camera.orthographic_height = height_;
    }
    return camera;
}

/// Returns the picture's height at the pivot's depth, world units.
double CameraRig::height_at_pivot() const {
    if (orthographic()) return height_;
    const glm::dvec3 offset = pivot_ - position_;
    const double depth = std::max(glm::dot(offset, forward()), kNearestDepth * glm::length(offset));
    return 2 * std::tan(vertical_fov_ / 2) * depth;
}

void CameraRig::set_orthographic(bool parallel) {
    if (parallel == orthographic()) return;
    if (parallel) {
        height_ = std::max(height_at_pivot(), 1e-9);
        return;
    }
    const double depth = height_ / (2 * std::tan(vertical_fov_ / 2));
    position_ += forward() * (glm::dot(pivot_ - position_, forward()) - depth);
    height_ = 0;
}

void CameraRig::look_along(double yaw, double pitch) {
    const double distance = glm::distance(pivot_, position_);
    yaw_ = yaw;
    pitch_ = std::clamp(pitch, -kSteepest, kSteepest);
    position_ = pivot_ - forward() * distance;
}

void CameraRig::fit(const std::array<glm::dvec3, 2>& box, const PictureShape& shape) {
    std::array<glm::dvec3, 8> corners;
    for (size_t i = 0; i < corners.size(); ++i)
        corners[i] = {box[i & 1].x, box[i >> 1 & 1].y, box[i >> 2 & 1].z};
    const ViewAxes axes{right(), up(), forward()};
    constexpr double kLeast = 2e-6;  // world units: a single point has a size
    pivot_ = (box[0] + box[1]) / 2.0;
    if (orthographic()) {
        const ParallelFit fit = parallel_fit(corners, axes, shape, kLeast);
        position_ = fit.position;
        height_ = fit.height;
    } else {
        position_ = fitting_position(corners, axes, vertical_fov_, shape, kLeast);
    }
}

glm::dvec3 CameraRig::forward() const {
    return {std::cos(pitch_) * std::cos(yaw_), std::cos(pitch_) * std::sin(yaw_), std::sin(pitch_)};
}
glm::dvec3 CameraRig::right() const {
    return {std::sin(yaw_), -std::cos(yaw_), 0};
}
glm::dvec3 CameraRig::up() const {
    return glm::cross(right(), forward());
}

CameraRig::Ray CameraRig::ray(const glm::dvec2& place, double aspect) const {
    const double half = orthographic() ? height_ / 2 : std::tan(vertical_fov_ / 2);
    const glm::dvec3 aside = right() * (place.x * half * aspect) + up() * (place.y * half);
    if (orthographic()) return {position_ + aside, forward()};
    return {position_, forward() + aside};
}

void CameraRig::orbit(double yaw, double pitch) {
    const glm::dvec3 offset = pivot_ - position_;
    const glm::dvec3 seen(glm::dot(offset, right()), glm::dot(offset, up()), glm::dot(offset, forward()));
    look(yaw, pitch);
    position_ = pivot_ - right() * seen.x - up() * seen.y - forward() * seen.z;
}

void CameraRig::look(double yaw, double pitch) {
    yaw_ = std::remainder(yaw_ + yaw, 2 * std::numbers::pi);
    pitch_ = std::clamp(pitch_ + pitch, -kSteepest, kSteepest);
}

void CameraRig::pan(const glm::dvec2& shift) {
    const glm::dvec3 step = -(right() * shift.x + up() * shift.y) * height_at_pivot();
    position_ += step;
    pivot_ += step;
}

void CameraRig::zoom(double factor, const glm::dvec3& point) {
    pivot_ = point;
    const glm::dvec3 offset = position_ - point, depth = forward() * glm::dot(offset, forward());
    position_ = point + (orthographic() ? (offset - depth) * factor + depth : offset * factor);
    height_ *= factor;
}

void CameraRig::fly(const glm::dvec3& step) {
    const glm::dvec3 move = right() * step.x + glm::dvec3(0, 0, step.y) + forward() * step.z;
    position_ += move;
    pivot_ += move;
}

void CameraRig::walk(const glm::dvec3& step) {
    const glm::dvec3 ahead(std::cos(yaw_), std::sin(yaw_), 0);
    const glm::dvec3 move = right() * step.x + ahead * step.z;
    position_ += move;
    pivot_ += move;
}

}  // namespace lucarne::viewer
