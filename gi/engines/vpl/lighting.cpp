#include "gi/engines/vpl/lighting.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "gi/bounce_options.h"

namespace lucarne::gi::vpl {
namespace {

constexpr uint32_t kLeastOfBounce = 16;  ///< VPLs of a bounce, so that each tile of 4 x 4 has one

double all_leaving(const Seeds& seeds) {
    double sum = 0;
    for (const VplLight& light : seeds.host_lights) sum += leaving_light(light);
    return std::isfinite(sum) ? sum : 0;
}

/// Returns how many of `count` VPLs each bounce gets; at most `count` of each, and `count` in all if there is
/// any light.
std::vector<uint32_t> shares_of(const std::vector<Bounce>& bounces, uint32_t count) {
    std::vector<double> light;
    for (const Bounce& bounce : bounces) light.push_back(all_leaving(bounce.seeds));
    const double all = std::accumulate(light.begin(), light.end(), 0.0);
    std::vector<uint32_t> shares(bounces.size(), 0);
    uint32_t later = 0;
    for (size_t i = bounces.size(); i-- > 1;) {
        if (!(light[i] > 0)) continue;
        const auto wanted = static_cast<uint32_t>(std::lround(count * light[i] / all));
        // The first bounce keeps at least as many as the least of all others.
        shares[i] = std::min(std::max(wanted, kLeastOfBounce), count > later ? (count - later) / 2 : 0);
        later += shares[i];
    }
    shares[0] = count - later;
    return shares;
}

}  // namespace

bool Lighting::serves(const Basis& now) const {
    return basis.whole() && basis.scene.bounds == now.scene.bounds &&
           basis.settings[kBounces] == now.settings[kBounces] &&
           basis.settings[kOnlyBounce] == now.settings[kOnlyBounce];
}

Result<void> unite_bounces(Device& device, Lighting& lighting) {
    const uint32_t count = lighting.layout.maps;
    const size_t map_bytes = lighting.layout.texels() / count * sizeof(uint32_t);
    LUCARNE_TRY(device.reserve(lighting.united.atlas, count * map_bytes, "ISM atlas"));
    LUCARNE_TRY(
        device.reserve(lighting.united.seeds.lights, count * sizeof(VplLight), "virtual point lights"));
    const std::vector<uint32_t> shares = shares_of(lighting.bounces, count);
    std::vector<VplLight>& united = lighting.united.seeds.host_lights;
    united.clear();
    for (size_t bounce = 0; bounce < shares.size(); ++bounce) {
        const Bounce& from = lighting.bounces[bounce];
        const uint32_t share = shares[bounce];
        // Not the host's copy, whose footprints were not trimmed.
        const auto lights = from.seeds.lights.download_all<VplLight>(count);
        for (uint32_t i = 0; i < share; ++i) {
            const auto index = static_cast<uint32_t>((uint64_t{i} * 2 + 1) * count / (uint64_t{share} * 2));
            VplLight light = lights[index];
            const float scale = static_cast<float>(count) / static_cast<float>(share);
            light.position.w *= scale;
            for (glm::vec4* energy : {&light.diffuse, &light.flux})
                for (int channel = 0; channel < 3; ++channel) (*energy)[channel] *= scale;
            lighting.united.atlas.copy_from(from.atlas, index * map_bytes, united.size() * map_bytes,
                                            map_bytes);
            united.push_back(light);
        }
    }
    lighting.united.seeds.lights.upload_all(united);
    lighting.is_united = true;
    return {};
}

float ambient_irradiance(const Seeds& first_bounce, const Bounds& scene, uint32_t bounces) {
    constexpr double kAlbedo = .5;
    const glm::dvec3 size = glm::dvec3(scene.max) - glm::dvec3(scene.min);
    const double area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
    const double all_bounces = (1 - std::pow(kAlbedo, bounces)) / (1 - kAlbedo);
    const double irradiance =
        std::numbers::pi * all_leaving(first_bounce) / std::max(area, 1e-6) * all_bounces;
    return std::isfinite(irradiance) ? static_cast<float>(irradiance) : 0.0f;
}

}  // namespace lucarne::gi::vpl
