#pragma once

#include "io/formats/mesh/mesh.h"
#include "io/formats/mesh/sampler.h"

namespace lucarne::io::mesh {

/// What a mesh looks like at a sample: normals interpolated between corners, colours in linear light.
class Surface {
 public:
    Surface(const Mesh& mesh, double spacing);
    /// Of length 1, on the side from which the corners turn left unless the corners' own normals say
    /// otherwise.
    glm::vec3 normal(const Sample& sample) const;
    /// The texture, averaged over the sample's square of its triangle; else the triangle's colour, else that
    /// of its corners, else its material's.
    Color8 color(const Sample& sample) const;

 private:
    Color8 textured(const Sample& sample, const Material& material, const Corners& corners) const;
    glm::vec3 texel(const Image8& image, const Material& material, const glm::dvec2& at) const;

    const Mesh& mesh_;
    double spacing_;
    std::array<float, 256> linear_;  ///< of an sRGB byte
};

}  // namespace lucarne::io::mesh
