#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"
#include "io/synthetic/patch_mesh.h"
#include "io/synthetic/scenes.h"

namespace lucarne::io {

struct SurfaceHit {
    double distance = 0;  ///< along the ray, or to the query point; metres
    glm::dvec3 position{0.0};
    glm::dvec3 normal{0.0};  ///< unit length, towards the air
    Finish finish = Finish::white;
    glm::dvec3 albedo() const { return albedo_at(finish, position, normal); }  ///< linear Rec. 709
};

/// The true surface of a virtual scan, against which measurements can be checked. Thread-safe once created.
/// The surface is the tessellation itself: curved bodies are meshes, and their normals are interpolated
/// between corners.
class SceneGeometry {
 public:
    /// Unknown names are ErrorKind::arguments; the error lists the known names.
    static Result<std::shared_ptr<const SceneGeometry>> create(const std::string& scene);
    ~SceneGeometry();
    SceneGeometry(const SceneGeometry&) = delete;
    SceneGeometry& operator=(const SceneGeometry&) = delete;

    /// Returns the first surface on the ray from `origin` along the unit `direction`, or nothing.
    std::optional<SurfaceHit> cast(const glm::dvec3& origin, const glm::dvec3& direction,
                                   double longest = std::numeric_limits<double>::infinity()) const;
    /// Returns the nearest place on the surface within `radius`, or nothing.
    std::optional<SurfaceHit> closest(const glm::dvec3& point,
                                      double radius = std::numeric_limits<double>::infinity()) const;
    double area() const { return model_.mesh.area(); }  ///< m^2, including surfaces hidden inside others
    glm::dvec3 min() const { return min_; }
    glm::dvec3 max() const { return max_; }
    const PatchMesh& mesh() const { return model_.mesh; }
    const SceneModel& model() const { return model_; }

 private:
    explicit SceneGeometry(SceneModel model);
    SceneModel model_;
    glm::dvec3 min_{0.0}, max_{0.0};
    struct Embree;
    std::unique_ptr<Embree> embree_;
};

}  // namespace lucarne::io
