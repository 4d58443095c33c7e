#include "gi/post/share_edges.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/post/bindings.h"
#include "gi/raster/coverage_code.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

using raster::kCoverageNeighbours, raster::kCoverageSamples;

constexpr size_t kPixelsPerTask = size_t{1} << 14;

struct MappedPicture {
    const glm::vec4* sample;
    const GBufferTexel* texels;
    const uint32_t* coverage;
    uint32_t width;
};

/// Calls add(pixel, samples) for each pixel whose surface the samples of a pixel show.
template <class Add>
void each_shown(uint32_t word, size_t at, uint32_t width, const Add& add) {
    uint32_t own = kCoverageSamples;
    for (uint32_t i = 0; word && i < kCoverageNeighbours; ++i) {
        const uint32_t samples = word >> (4 * i) & 15u;
        if (samples == 0) continue;
        own -= samples;
        const glm::ivec2 step = raster::coverage_neighbour(i);
        add(at + static_cast<size_t>(step.y * static_cast<int>(width) + step.x), static_cast<float>(samples));
    }
    if (own > 0) add(at, static_cast<float>(own));
}

/// Returns what a pixel shows. See share_edges.comp.
glm::vec4 shared_light(const MappedPicture& picture, size_t at, bool points_only) {
    float points = 0, weights = 0;
    glm::vec3 light(0);
    each_shown(picture.coverage[at], at, picture.width, [&](size_t from, float weight) {
        if (picture.texels[from].depth != 0)
            points += weight;
        else if (points_only)
            return;
        light += weight * glm::vec3(picture.sample[from]);
        weights += weight;
    });
    return {weights > 0 ? light / weights : glm::vec3(0), points / static_cast<float>(kCoverageSamples)};
}

Result<void> share_natively(const Buffer& sample, const GBuffer& gbuffer, bool points_only, Buffer& mean) {
    LUCARNE_ASSIGN(const MappedBuffer sample_memory, sample.map());
    LUCARNE_ASSIGN(const MappedBuffer texel_memory, gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer coverage_memory, gbuffer.coverage.map());
    LUCARNE_ASSIGN(const MappedBuffer mean_memory, mean.map());
    const MappedPicture picture{sample_memory.as<const glm::vec4>().data(),
                                texel_memory.as<const GBufferTexel>().data(),
                                coverage_memory.as<const uint32_t>().data(), gbuffer.width};
    glm::vec4* const out = mean_memory.as<glm::vec4>().data();
    parallel_ranges(size_t{gbuffer.width} * gbuffer.height, kPixelsPerTask, [&](size_t first, size_t last) {
        for (size_t at = first; at < last; ++at) out[at] = shared_light(picture, at, points_only);
    });
    return {};
}

}  // namespace

Result<void> share_edges(Device& device, const Buffer& sample, const GBuffer& gbuffer, bool points_only,
                         Buffer& mean) {
    if (device.native_passes()) return share_natively(sample, gbuffer, points_only, mean);
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/share_edges.comp"));
    const uint32_t pixels = gbuffer.width * gbuffer.height;
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    sample.bind(post::kBindRadiance);
    mean.bind(post::kBindMean);
    gbuffer.coverage.bind(post::kBindCoverage);
    program->set("pixels", pixels);
    program->set("width", gbuffer.width);
    program->set("points_only", points_only ? 1u : 0u);
    program->dispatch(pixels);
    return {};
}

std::vector<glm::vec4> share_edges(std::span<const glm::vec4> values, const GBuffer& gbuffer) {
    const auto coverage = gbuffer.coverage.download_all<uint32_t>(values.size());
    std::vector<glm::vec4> shared(values.size(), glm::vec4(0));
    for (size_t at = 0; at < values.size(); ++at)
        each_shown(coverage[at], at, gbuffer.width, [&](size_t from, float samples) {
            shared[at] += samples / static_cast<float>(kCoverageSamples) * values[from];
        });
    return shared;
}

}  // namespace lucarne::gi
