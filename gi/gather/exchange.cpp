#include "gi/gather/exchange.h"

#include "gi/shared/lobe.h"

namespace lucarne::gi {
namespace {

glm::vec3& side_of(SideLight& light, bool back) {
    return back ? light.back : light.front;
}

}  // namespace

void add_reflected(const Reflectance& reflectance, const Arrived& arrived, uint32_t surfel, bool back,
                   std::vector<SideLight>& light, SideLobes& lobes) {
    side_of(light[surfel], back) += reflectance.kd / kPi * arrived.irradiance;
    if (lobes.light.empty()) return;
    side_of(lobes.light[surfel], back) += reflectance.ks * arrived.irradiance;
    side_of(lobes.directions[surfel], back) +=
        reflectance.ks * lobe_mean_cosine(reflectance.exponent) * arrived.directions;
}

void clear_light(std::vector<SideLight>& light, SideLobes& lobes) {
    light.assign(light.size(), {});
    lobes.light.assign(lobes.light.size(), {});
    lobes.directions.assign(lobes.directions.size(), {});
}

}  // namespace lucarne::gi
