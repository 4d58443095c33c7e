#include "gi/engines/vpl/seeding/emitters.h"

#include <algorithm>

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/surfel.h"
#include "io/core/random.h"

namespace lucarne::gi::vpl {

Result<void> weigh_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& target) {
    LUCARNE_ASSIGN(const Program* weigh, device.program("gi/engines/vpl/seeding/emitters.comp"));
    const uint32_t ids = cut.blocks() * kBlockSurfels;
    target.running.clear();
    if (ids == 0) return {};
    LUCARNE_TRY(device.reserve(target.scratch, ids * sizeof(float), "emitting surfels"));
    cut.bind();
    materials.bind(kBindMaterials);
    target.scratch.bind(kBindEmitters);
    weigh->dispatch(ids);
    double sum = 0;
    target.running.reserve(ids);
    for (const float weight : target.scratch.download_all<float>(ids)) {
        sum += weight > 0 ? weight : 0.0f;  // NaN: 0
        target.running.push_back(sum);
    }
    return {};
}

std::vector<uint32_t> draw_emitters(std::span<const double> running, uint32_t count, uint64_t seed) {
    std::vector<uint32_t> chosen;
    if (running.empty() || !(running.back() > 0)) return chosen;
    Random random(seed, count);
    for (uint32_t i = 0; i < count; ++i) {
        const double at = (i + random.uniform()) / count * running.back();
        auto found = std::upper_bound(running.begin(), running.end(), at);
        // Rounding may go past the end; then take the last surfel with a weight.
        if (found == running.end()) found = std::lower_bound(running.begin(), running.end(), running.back());
        const auto id = static_cast<uint32_t>(found - running.begin());
        // Choose sides by multiples of the golden ratio, so that both sides are balanced among any few
        // surfels in a row.
        const auto side = (static_cast<uint32_t>(seed) + i * 2654435769u) >> 31;
        chosen.push_back(id << 1 | side);
    }
    return chosen;
}

Result<void> seed_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& emitters,
                           uint32_t count, uint64_t seed, uint32_t first, Seeds& target) {
    LUCARNE_ASSIGN(const Program* emit, device.program("gi/engines/vpl/seeding/emit.comp"));
    const auto chosen = draw_emitters(emitters.running, count, seed);
    if (chosen.empty()) return {};
    LUCARNE_TRY(device.reserve(emitters.scratch, chosen.size() * sizeof(uint32_t), "emitting surfels"));
    emitters.scratch.upload_all(chosen);
    cut.bind();
    materials.bind(kBindMaterials);
    emitters.scratch.bind(kBindEmitters);
    target.lights.bind(kBindLights);
    emit->set("first_light", first);
    emit->set("light_count", count);
    emit->set("weight_sum", static_cast<float>(emitters.sum()));
    emit->dispatch(count);
    return {};
}

}  // namespace lucarne::gi::vpl
