#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/formats/mesh/mesh.h"

// Samples a mesh with blue noise, block by block. The samples are the same for any number of threads and any
// order.
//
// Candidates are stratified by area: the mesh's triangles are halved until a piece has a share of at most one
// candidate, and a piece's random numbers follow from its triangle and its place in it. From the candidates a
// Poisson-disk set is chosen as if by throwing darts in the order of a hash (Cook 1986; in parallel: Bowers
// et al. 2010, "Parallel Poisson disk sampling with spectrum analysis on surfaces"). A candidate is kept
// unless an earlier kept one lies within the disc's radius and faces the same side. This depends only on the
// candidate's neighbourhood, so each block of space is computed with a halo around it. If the halo turns out
// too thin to decide, the block is computed again with a wider one.
namespace lucarne::io::mesh {

/// The radius of the discs in spacings: no two samples are nearer. With this radius the average is one sample
/// per square of the spacing.
inline constexpr double kNearest = 0.76;

struct Sample {
    glm::dvec3 position;
    glm::vec2 share;  ///< barycentric weights of the second and third corner
    uint32_t triangle;
};

class Sampler {
 public:
    /// The mesh must be finished and must outlive this. The spacing must be at least a millionth of the box's
    /// diagonal.
    Sampler(const Mesh& mesh, double spacing);
    /// Returns the samples of the next blocks, computed on all cores; false at the end.
    bool next(std::vector<Sample>& samples);

 private:
    struct Block {
        glm::ivec3 low, high;  ///< in cells
        std::vector<uint32_t> triangles;
    };
    struct Region;
    struct Candidates;
    struct Face;
    struct Piece;

    Region region_of(const Block& block, int halo) const;
    void split(Block block, std::vector<Block>& children) const;
    void sample(Block block, std::vector<Sample>& samples) const;
    bool gather(const Region& region, const Block& block, bool may_fail, Candidates& found) const;
    void cut(const Region& region, const Face& face, const Piece& piece, Candidates& found) const;
    bool choose(const Region& region, const Block& block, bool surely, const Candidates& candidates,
                std::vector<Sample>& samples) const;

    const Mesh& mesh_;
    double radius_, cell_, density_;  ///< a cell's side is two radii; density is candidates per area
    glm::dvec3 origin_;
    glm::ivec3 cells_;
    std::vector<Block> stack_;
};

}  // namespace lucarne::io::mesh
