#pragma once

#include "io/formats/mesh/mesh.h"
#include "io/formats/mesh/sampler.h"

namespace lucarne::io::mesh {

/// What a mesh looks like at a sample: normals interpolated between corners, colours averaged in linear
/// light.
class Surface {
 public:
    Surface(const Mesh& mesh, double spacing);
    /// Returns the unit normal: from the corners' own normals if they have some, otherwise the face's, on the
    /// side from which its corners turn left.
    glm::vec3 normal(const Sample& sample) const;
    /// Returns the colour: the texture, averaged over the sample's square within its triangle; otherwise the
    /// colour of the triangle, of its corners or of its material, in this order.
    Color8 color(const Sample& sample) const;

 private:
    Color8 textured(const Sample& sample, const Material& material, const Corners& corners) const;
    glm::vec3 texel(const Image8& image, const Material& material, const glm::dvec2& at) const;

    const Mesh& mesh_;
    double spacing_;
    std::array<float, 256> linear_;  ///< of an sRGB byte
};

}  // namespace lucarne::io::mesh
