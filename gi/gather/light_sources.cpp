#include "gi/gather/light_sources.h"

#include <algorithm>

#include "gi/shared/lobe.h"

namespace lucarne::gi {

LightSources::LightSources(std::span<const uint32_t> surfels, std::span<const float> areas,
                           std::span<const SideLight> light, const SideLobes& lobes)
    : surfels_(surfels), areas_(areas), light_(light), lobes_(lobes), kinds_(lobes.light.empty() ? 2 : 4) {
    ends_.reserve(surfels.size() * kinds_);
    double sum = 0;
    for (size_t i = 0; i < surfels.size() * kinds_; ++i) {
        sum += std::max(0.0f, mean_colour(flux(source(i))));
        ends_.push_back(sum);
    }
}

LightSource LightSources::at(double share) const {
    const auto found = std::upper_bound(ends_.begin(), ends_.end(), share * total());
    return source(std::min(static_cast<size_t>(found - ends_.begin()), ends_.size() - 1));
}

glm::vec3 LightSources::exitance(const LightSource& source) const {
    const SideLight& light = source.specular ? lobes_.light[source.surfel] : light_[source.surfel];
    return (source.specular ? 1.0f : kPi) * (source.back ? light.back : light.front);
}

glm::vec3 LightSources::flux(const LightSource& source) const {
    return areas_[2 * source.traced + (source.back ? 1 : 0)] * exitance(source);
}

LightSource LightSources::source(size_t i) const {
    const size_t traced = i / kinds_, kind = i % kinds_;
    return {traced, surfels_[traced], (kind & 1) != 0, kind >= 2};
}

}  // namespace lucarne::gi
