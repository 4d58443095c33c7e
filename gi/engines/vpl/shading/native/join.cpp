#include "gi/engines/vpl/shading/native/join.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/shading/native/window.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shading/native/join.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/surfaces-inl.h"

#ifndef LUCARNE_NATIVE_JOIN_ONCE
#define LUCARNE_NATIVE_JOIN_ONCE
namespace lucarne::gi::vpl::native {

constexpr int kBand = 32;  ///< rows that a thread takes at a time

struct JoinJob {
    const CameraView& camera;
    const GBufferTexel* texels;
    int n;
    std::span<const Candidate> candidates;
    uint32_t* joints;
};

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
/// Writes the joints of a row and adds its isolated pixels.
void join_row(const JoinJob& job, const Surfaces& from, size_t row, int y, std::vector<uint32_t>& isolated) {
    const Floats df;
    const Words du;
    const auto width = static_cast<int>(job.camera.width);
    const bool parallel = job.camera.projection == kOrthographic;
    const float height = static_cast<float>(job.n) * 2 * glm::length(glm::vec3(job.camera.up)) /
                         static_cast<float>(job.camera.height);
    const F zero = hn::Zero(df), one = set(1.0f);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const size_t at = row * from.stride + kBorder + static_cast<size_t>(x);
        const F depth = hn::LoadU(df, &from.depth[at]);
        const Mask shown = hn::Gt(depth, zero);
        if (hn::AllFalse(df, shown)) {
            std::fill_n(job.joints + 2 * (static_cast<size_t>(y) * job.camera.width + static_cast<size_t>(x)),
                        2 * std::min(static_cast<int>(hn::Lanes(df)), width - x), 0u);
            continue;
        }
        const V3 p{hn::LoadU(df, &from.x[at]), hn::LoadU(df, &from.y[at]), hn::LoadU(df, &from.z[at])},
            normal{hn::LoadU(df, &from.nx[at]), hn::LoadU(df, &from.ny[at]), hn::LoadU(df, &from.nz[at])};
        const F sigma = parallel ? set(height) : mul(set(height), depth);
        const F per_sigma = over(one, sigma);
        U words[2] = {hn::Zero(du), hn::Zero(du)};
        for (const Candidate& candidate : job.candidates) {
            const size_t other = at + static_cast<size_t>(static_cast<ptrdiff_t>(candidate.dy) *
                                                              static_cast<ptrdiff_t>(from.stride) +
                                                          candidate.dx);
            const V3 offset{sub(hn::LoadU(df, &from.x[other]), p.x), sub(hn::LoadU(df, &from.y[other]), p.y),
                            sub(hn::LoadU(df, &from.z[other]), p.z)};
            const V3 turned{hn::LoadU(df, &from.nx[other]), hn::LoadU(df, &from.ny[other]),
                            hn::LoadU(df, &from.nz[other])};
            // alike() of join.comp with exp() in place of log(): max(0, n.n') >= exp((plane / sigma - 1) /
            // 32). The series is exact to 1e-7 where the two sides can be equal.
            const F power = mul(sub(mul(hn::Abs(dot(normal, offset)), per_sigma), one), set(1 / 32.0f));
            F least = add(mul(power, set(1 / 6.0f)), set(0.5f));
            least = add(one, mul(power, add(one, mul(power, least))));
            Mask alike = hn::Ge(dot(normal, turned), least);
            alike = hn::And(alike, hn::Gt(hn::LoadU(df, &from.depth[other]), zero));
            const U bit = hn::IfThenElseZero(hn::RebindMask(du, hn::And(alike, shown)), word(candidate.bit));
            words[candidate.word] = hn::Or(words[candidate.word], bit);
        }
        alignas(64) uint32_t joint[2 * kLanes];
        hn::StoreInterleaved2(words[0], words[1], du, joint);
        const int count = std::min(static_cast<int>(hn::Lanes(df)), width - x);
        const size_t pixel = static_cast<size_t>(y) * job.camera.width + static_cast<size_t>(x);
        std::memcpy(job.joints + 2 * pixel, joint, 2 * sizeof(uint32_t) * static_cast<size_t>(count));
        const uint32_t seen = bits_of(shown);
        for (int lane = 0; lane < count; ++lane) {
            if (!(seen >> lane & 1)) continue;
            const auto found = [&](uint32_t bits) {
                return std::popcount((bits | bits >> 1 | bits >> 2 | bits >> 3) & 0x11111111u);
            };
            if (2 * (found(joint[2 * lane]) + found(joint[2 * lane + 1])) < job.n * job.n)
                isolated.push_back(static_cast<uint32_t>(pixel) + static_cast<uint32_t>(lane));
        }
    }
}

void JoinBand(const JoinJob& job, int first, int end, std::vector<uint32_t>& isolated) {
    const auto height = static_cast<int>(job.camera.height);
    Surfaces surfaces(job.camera.width, kBand + 2 * kBorder);
    const auto row_of = [&](int y) { return static_cast<size_t>(y - first + kBorder); };
    for (int y = std::max(0, first - 2 * job.n); y < std::min(height, end + 2 * job.n); ++y)
        read_row(job.camera, job.texels, y, row_of(y), surfaces);
    for (int y = first; y < end; ++y) join_row(job, surfaces, row_of(y), y, isolated);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(JoinBand);
std::vector<uint32_t> join(const CameraView& camera, const GBufferTexel* texels, uint32_t n,
                           uint32_t* joints) {
    const auto all = candidates(static_cast<int>(n));
    const JoinJob job{camera, texels, static_cast<int>(n), all, joints};
    std::vector<std::vector<uint32_t>> isolated((camera.height + kBand - 1) / kBand);
    parallel_ranges(camera.height, kBand, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(JoinBand)
        (job, static_cast<int>(first), static_cast<int>(end), isolated[first / kBand]);
    });
    std::vector<uint32_t> joined;
    for (const auto& band : isolated) joined.insert(joined.end(), band.begin(), band.end());
    return joined;
}

}  // namespace lucarne::gi::vpl::native
#endif
