#include "gi/raster/gbuffer.h"

#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>

#include "gi/raster/bindings.h"
#include "gi/raster/native/native.h"
#include "gi/raster/queues.h"

namespace lucarne::gi {
namespace {

const Defines kIdPass = {{"LUCARNE_ID_PASS", "1"}};

/// `places` is the number of ids of the cut, gaps included.
Result<void> reserve_scratch(Device& device, size_t pixels, size_t places, GBuffer& target) {
    const auto hold = [&](Buffer& buffer, size_t bytes) { return device.reserve(buffer, bytes, "G-buffer"); };
    LUCARNE_TRY(hold(target.keys, pixels * sizeof(uint32_t)));
    LUCARNE_TRY(hold(target.queues, sizeof(QueueHeader) + kLargeQueue * sizeof(uint32_t)));
    LUCARNE_TRY(hold(target.candidates, places * sizeof(uint32_t)));
    return hold(target.seen_blocks, places / kBlockSurfels * 2 * sizeof(uint32_t));
}

Result<void> draw_large(Device& device, const CameraView& view, const PointSize& size, const GBuffer& target,
                        const Defines& defines) {
    LUCARNE_ASSIGN(const Program* queued, device.program("gi/raster/splat_large.comp", defines));
    LUCARNE_ASSIGN(const Program* overflow, device.program("gi/raster/splat_overflow.comp", defines));
    for (const Program* program : {queued, overflow}) set_disc_view(*program, view, size);
    queued->dispatch_indirect(target.queues, offsetof(QueueHeader, large_groups));
    overflow->dispatch_indirect(target.queues, offsetof(QueueHeader, overflow_groups));
    return {};
}

}  // namespace

Result<void> rasterize(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                       const PointSize& size) {
    const size_t pixels = size_t{view.width} * view.height;
    const uint32_t places = cut.blocks() * kBlockSurfels;
    target.width = view.width;
    target.height = view.height;
    LUCARNE_TRY(device.reserve(target.texels, pixels * sizeof(GBufferTexel), "G-buffer"));
    LUCARNE_TRY(device.reserve(target.ids, pixels * sizeof(uint32_t), "G-buffer"));
    if (native::draws(device, cut))
        return native::rasterize(cut, disc_view(view, size), target.texels, target.ids, target.to_blend);
    LUCARNE_TRY(reserve_scratch(device, pixels, places, target));
    LUCARNE_ASSIGN(const Program* splat, device.program("gi/raster/splat.comp"));
    LUCARNE_ASSIGN(const Program* splat_ids, device.program("gi/raster/splat.comp", kIdPass));
    LUCARNE_ASSIGN(const Program* plan, device.program("gi/raster/plan.comp"));
    LUCARNE_ASSIGN(const Program* resolve, device.program("gi/raster/resolve.comp"));
    target.keys.clear(UINT32_MAX);
    target.ids.clear(kNoSurfel);
    target.queues.clear(0);
    target.seen_blocks.clear(0);
    cut.bind();
    target.keys.bind(raster::kBindKeys);
    target.keys.bind_texels(raster::kUnitKeys, TexelView::four_words);
    target.ids.bind(raster::kBindIds);
    target.queues.bind(raster::kBindQueues);
    target.texels.bind(raster::kBindTexels);
    target.candidates.bind(raster::kBindCandidates);
    target.seen_blocks.bind(raster::kBindBlocks);
    for (const Program* program : {splat, splat_ids, resolve}) set_disc_view(*program, view, size);
    for (const Program* program : {plan, resolve}) program->set("blocks", cut.blocks());
    splat->dispatch(places);
    plan->dispatch(1);
    LUCARNE_TRY(draw_large(device, view, size, target, {}));
    splat_ids->dispatch_indirect(target.queues, offsetof(QueueHeader, candidate_groups));
    LUCARNE_TRY(draw_large(device, view, size, target, kIdPass));
    resolve->dispatch(static_cast<uint32_t>(pixels));
    return {};
}

CameraView spot_view(const Light& spot, uint32_t resolution) {
    const glm::vec3 forward(spot.direction.x, spot.direction.y, spot.direction.z);
    // Any frame about the axis will do; the helper is an axis far from it.
    const glm::vec3 helper = std::abs(forward.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(forward, helper));
    const glm::vec3 up = glm::cross(right, forward);
    // A pinhole view cannot show a half space: fields of view beyond 170 degrees are limited to that.
    const float cosine = std::max(spot.position.w, std::cos(1.4835f));
    const float tangent = std::sqrt(std::max(1 - cosine * cosine, 1e-6f)) / cosine;
    CameraView view{};
    constexpr float kNear = 1e-3f;  // m
    view.origin = {spot.position.x, spot.position.y, spot.position.z, kNear};
    view.forward = {forward.x, forward.y, forward.z, 0.0f};
    view.right = {right.x * tangent, right.y * tangent, right.z * tangent, 0.0f};
    view.up = {up.x * tangent, up.y * tangent, up.z * tangent, 0.0f};
    view.width = view.height = resolution;
    return view;
}

}  // namespace lucarne::gi
