// Discs of pipes, which are a few points wide and were seen from one side.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "octree/tree/edge_line.h"
#include "tests/octree/normals/surface_truth.h"

namespace lucarne::octree {
namespace {

using namespace testing;

constexpr double kRadius = 0.03, kLength = 6, kSpacing = 0.012, kSeen = 1.8;  ///< m; radians to both sides

Cloud half_seen_pipe() {
    Random random(23);
    Cloud pipe;
    const auto count = static_cast<size_t>(2 * kSeen * kRadius * kLength / (kSpacing * kSpacing));
    for (size_t i = 0; i < count; ++i) {
        const double angle = kSeen * (2 * random.uniform() - 1), along = kLength * random.uniform();
        const glm::dvec3 n(0, std::sin(angle), std::cos(angle));
        const double off = 0.003 * gaussian(random);
        pipe.points.push_back((kRadius + off) * n + glm::dvec3(along, 0, 0));
        pipe.normals.push_back(n);
    }
    return pipe;
}

/// Discs of the outermost points of a pipe had whole cells on the side where nothing cuts them, and lines
/// only at creases that are none, so the outlines of pipes were strings of beads.
TEST(Pipes, HaveSmoothOutlines) {
    const Cloud pipe = half_seen_pipe();
    const Estimate found = estimate(pipe);
    Random random(24);
    constexpr int kSamples = 64;
    double all = 0, over = 0;  // faces of the discs, m2; those of them more than a spacing over the pipe
    for (size_t i = 0; i < pipe.points.size(); ++i) {
        const double radius = drawn_radius(found, i);
        if (!(radius > 0) || found.normals[i] == glm::vec3(0.0f)) continue;
        const glm::dvec3 n(found.normals[i]);
        const glm::dvec3 u =
            glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        const auto line = decode_edge(found.normals[i], found.edges[i].code);
        int beyond = 0;
        for (int k = 0; k < kSamples; ++k) {
            const double reach = radius * std::sqrt(random.uniform()),
                         turn = 2 * std::numbers::pi * random.uniform();
            const glm::dvec3 offset = reach * (std::cos(turn) * u + std::sin(turn) * glm::cross(n, u));
            if (line && glm::dot(glm::dvec3(line->toward), offset) >
                            line->distance * std::sqrt(double{found.areas[i]}))
                continue;
            const glm::dvec3 p = pipe.points[i] + offset;
            beyond += std::hypot(p.y, p.z) > kRadius + kSpacing;
        }
        const double face = std::numbers::pi * radius * radius;
        all += face;
        over += face * beyond / kSamples;
    }
    std::printf("%.4f of %.4f m2 of discs' faces are more than a spacing over the pipe (%.3f)\n", over, all,
                over / all);
    EXPECT_LT(over / all, 0.0345) << "it was .038";
}

}  // namespace
}  // namespace lucarne::octree
