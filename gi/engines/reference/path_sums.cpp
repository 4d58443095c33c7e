#include "gi/engines/reference/path_sums.h"

#include <algorithm>
#include <cmath>

#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::reference {

void PathSums::add(const PathSums& other) {
    exact += other.exact;
    frames += other.frames;
    for (int half = 0; half < 2; ++half) {
        halves[half] += other.halves[half];
        paths[half] += other.paths[half];
    }
    luminance += other.luminance;
    squares += other.squares;
}

glm::vec3 PathSums::radiance() const {
    const auto all = static_cast<double>(std::max<uint64_t>(paths[0] + paths[1], 1));
    return glm::vec3(exact / static_cast<double>(frames) + (halves[0] + halves[1]) / all);
}

glm::vec3 PathSums::half_radiance(int half) const {
    if (!paths[half]) return radiance();
    return glm::vec3(exact / static_cast<double>(frames) + halves[half] / static_cast<double>(paths[half]));
}

float PathSums::variance() const {
    const auto n = static_cast<double>(paths[0] + paths[1]);
    if (n < 2) return 0;
    const double spread = std::max(0.0, squares - luminance * luminance / n) / (n - 1);
    return static_cast<float>(spread / n);
}

MeanLuminance mean_luminance(std::span<const PathSums> sums) {
    MeanLuminance result;
    if (sums.empty()) return result;
    double variance = 0;
    for (const PathSums& s : sums) {
        result.mean += luminance(s.radiance());
        variance += s.variance();
    }
    const auto count = static_cast<double>(sums.size());
    result.mean /= count;
    result.standard_error = std::sqrt(variance) / count;
    return result;
}

}  // namespace lucarne::gi::reference
