#pragma once

#include <array>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "viewer/camera/fitting.h"

namespace lucarne::viewer {

/// A camera that keeps the horizon level (z is up), and its pivot, the point it turns about. World units.
class CameraRig {
 public:
    CameraRig() : CameraRig(gi::SceneCamera{}) {}
    /// The pivot is the camera's target; a tilted `up` is levelled.
    explicit CameraRig(const gi::SceneCamera& camera);

    gi::SceneCamera camera() const;
    const glm::dvec3& position() const { return position_; }
    const glm::dvec3& pivot() const { return pivot_; }
    glm::dvec3 forward() const;
    glm::dvec3 right() const;
    glm::dvec3 up() const;

    /// The ray through a place of the picture, which is given in [-1, 1] to the right and up. `along` is
    /// scaled so that dot(along, forward) = 1.
    struct Ray {
        glm::dvec3 from, along;
    };
    Ray ray(const glm::dvec2& place, double aspect) const;
    void set_pivot(const glm::dvec3& pivot) { pivot_ = pivot; }
    void set_position(const glm::dvec3& position) { position_ = position; }

    bool orthographic() const { return height_ > 0; }
    /// Switches between orthographic and perspective projection. What lies at the pivot's depth keeps its
    /// size in the picture.
    void set_orthographic(bool parallel);
    /// Sets the least distance between an orthographic camera and the pivot, so that nothing lies behind the
    /// camera.
    void set_clearance(double distance) { clearance_ = distance; }
    /// Looks at the pivot from the given direction and keeps the distance.
    void look_along(double yaw, double pitch);
    /// Shows the whole box in the free part of the picture and keeps the direction of the view. The box's
    /// centre becomes the pivot.
    void fit(const std::array<glm::dvec3, 2>& box, const PictureShape& shape);

    /// Turns about the pivot, which stays where it is in the picture. Angles are radians to the left and up.
    /// The pitch stops short of straight up and straight down.
    void orbit(double yaw, double pitch);
    /// Turns in place.
    void look(double yaw, double pitch);
    /// Shifts the camera so that what lies at the pivot's depth follows the pointer. `shift` is in shares of
    /// the picture's height, to the right and up.
    void pan(const glm::dvec2& shift);
    /// Moves toward `point` (factor < 1) or away from it (factor > 1). The point stays where it is in the
    /// picture.
    void zoom(double factor, const glm::dvec3& point);
    /// Moves the camera and the pivot by a step right, up (z) and forward.
    void fly(const glm::dvec3& step);
    /// Like fly(), but forward is horizontal whatever the pitch.
    void walk(const glm::dvec3& step);

 private:
    glm::dvec3 position_{0.0}, pivot_{0.0};
    double yaw_ = 0, pitch_ = 0;  ///< direction of the view: yaw from +x toward +y, pitch upward
    double vertical_fov_ = 1;
    double height_ = 0;  ///< height of an orthographic picture, world units; 0: perspective
    double clearance_ = 0;

    double height_at_pivot() const;
};

}  // namespace lucarne::viewer
