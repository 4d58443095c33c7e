#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/formats/mesh/mesh.h"

// Blue noise on a mesh, in pieces that hang together: the same samples whatever the threads and the order.
//
// Candidates are stratified by area: the mesh's triangles are halved until a piece has a share of at most
// one, and a piece's random numbers follow from its triangle and its place in it. Of these a Poisson-disk set
// is chosen as by throwing darts in the order of a hash (Cook 1986; in parallel: Bowers et al. 2010,
// "Parallel Poisson disk sampling with spectrum analysis on surfaces"): a candidate stays unless one before
// it in that order stays within the disc's radius and faces the same side. That is a question about its
// neighbourhood only: a block of space is answered with a halo around it, and where the halo is too thin to
// be sure, again with a wider one.
namespace lucarne::io::mesh {

/// On average one sample stands on this many squares of the spacing; no two are nearer than kNearest
/// spacings.
inline constexpr double kNearest = 0.76;

struct Sample {
    glm::dvec3 position;
    glm::vec2 share;  ///< of the second and the third corner
    uint32_t triangle;
};

class Sampler {
 public:
    /// The mesh is finished and outlives this; its spacing at least a millionth of its box.
    Sampler(const Mesh& mesh, double spacing);
    /// The samples of the next blocks; false at the end. All cores work.
    bool next(std::vector<Sample>& samples);

 private:
    struct Block {
        glm::ivec3 low, high;  ///< cells
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
    double radius_, cell_, density_;  ///< a cell's side is two radii; density: candidates per area
    glm::dvec3 origin_;
    glm::ivec3 cells_;
    std::vector<Block> stack_;
};

}  // namespace lucarne::io::mesh
