#include "gi/scene/environment.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "gi/shared/environment.h"
#include "io/image/image.h"

namespace lucarne::gi {

size_t Environment::texel(const glm::vec3& direction) const {
    const glm::vec2 place = environment_place(direction, rotation);
    const auto x = std::min(static_cast<uint32_t>(place.x * static_cast<float>(width)), width - 1);
    const auto y = std::min(static_cast<uint32_t>(place.y * static_cast<float>(height)), height - 1);
    return size_t{y} * width + x;
}

Result<Environment> load_environment(const std::filesystem::path& path, const glm::dvec3& scale,
                                     double rotation) {
    const bool radiance_picture = path.extension() == ".hdr";
    LUCARNE_ASSIGN(const io::Image image, radiance_picture ? io::read_hdr(path, kMostEnvironmentTexels)
                                                           : io::read_exr(path, kMostEnvironmentTexels));
    Environment environment;
    environment.width = image.width;
    environment.height = image.height;
    environment.rotation = static_cast<float>(rotation);
    environment.image = path;
    environment.scale = scale;
    environment.texels.resize(image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec4& pixel = image.pixels[i];
        const glm::vec3 radiance = glm::max(glm::vec3(pixel.x, pixel.y, pixel.z), 0.0f) * glm::vec3(scale);
        if (!std::isfinite(pixel.x + pixel.y + pixel.z) ||
            !std::isfinite(radiance.x + radiance.y + radiance.z))
            return rejected(path.string(), fmt::format("its pixel ({}, {}) is no finite radiance",
                                                       i % image.width, i / image.width));
        environment.texels[i] = radiance;
    }
    return environment;
}

}  // namespace lucarne::gi
