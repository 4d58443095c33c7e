#pragma once

#include <array>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// A camera that keeps the horizon level (z is up), in world units, and the point it turns about.
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

    /// Through a place of the picture, [-1, 1] to the right and up; dot(along, forward) = 1.
    struct Ray {
        glm::dvec3 from, along;
    };
    Ray ray(const glm::dvec2& place, double aspect) const;
    void set_pivot(const glm::dvec3& pivot) { pivot_ = pivot; }
    void set_position(const glm::dvec3& position) { position_ = position; }

    bool orthographic() const { return height_ > 0; }
    /// What lies at the pivot's depth keeps its size.
    void set_orthographic(bool parallel);
    /// How far an orthographic view stands back from the pivot at least, so that nothing lies behind it.
    void set_clearance(double distance) { clearance_ = distance; }
    /// Looks from another side at the pivot, from as far.
    void look_along(double yaw, double pitch);
    /// Shows the whole of a box, from where the view looks now; its middle becomes the pivot.
    void fit(const std::array<glm::dvec3, 2>& box);

    /// Turns about the pivot, which stays where it is in the picture; radians to the left and up. Stops short
    /// of straight up and down.
    void orbit(double yaw, double pitch);
    /// Turns in place.
    void look(double yaw, double pitch);
    /// Shifts so that what lies at the pivot's depth follows the pointer; shares of the picture's height,
    /// right and up.
    void pan(const glm::dvec2& shift);
    /// Goes toward `point` (factor < 1) or away from it; what lies there stays where it is in the picture.
    void zoom(double factor, const glm::dvec3& point);
    /// Moves by a step right, up (z) and forward; the pivot comes along.
    void fly(const glm::dvec3& step);
    /// The same on the level, whatever the pitch.
    void walk(const glm::dvec3& step);

 private:
    glm::dvec3 position_{0.0}, pivot_{0.0};
    double yaw_ = 0, pitch_ = 0;  ///< of the view: from +x toward +y, and upward
    double vertical_fov_ = 1;
    double height_ = 0;  ///< of an orthographic picture, world units; 0: perspective
    double clearance_ = 0;

    double height_at_pivot() const;
};

}  // namespace lucarne::viewer
