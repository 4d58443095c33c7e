#include "gi/lighting/sky_directions.h"

#include <algorithm>
#include <cmath>

#include "gi/lighting/sky_grid.h"
#include "gi/shared/luminance.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kMostColumns = 512;
/// Share of the directions that are drawn by luminance alone: a direction that the importance missed counts
/// at most twice as much as without it.
constexpr double kByLuminance = 0.5;
constexpr uint32_t kProbes = 4;  ///< along both sides of a cell, where the luminance is looked up

/// Returns the first running sum that is beyond `at`, a share in [0, 1) of the last sum. Sets `at` to the
/// share within that step.
uint32_t take(std::span<const double> running, double& at) {
    const double value = at * running.back();
    size_t found = static_cast<size_t>(std::ranges::upper_bound(running, value) - running.begin());
    // Rounding may go past the end; then take the last step that is not empty.
    if (found == running.size())
        found = static_cast<size_t>(std::ranges::lower_bound(running, running.back()) - running.begin());
    const double before = found ? running[found - 1] : 0;
    at = std::clamp((value - before) / (running[found] - before), 0.0, 1.0 - 1e-15);
    return static_cast<uint32_t>(found);
}

/// Returns the direction of height z at `u`, a share of a turn from the left edge of an environment's
/// picture.
glm::vec3 toward(double z, double u, double rotation) {
    const double sine = std::sqrt(std::max(0.0, 1 - z * z));
    const double turns = 2 * M_PI * (u - .5) - rotation;  // from +y to +x
    return {sine * std::sin(turns), sine * std::cos(turns), z};
}

}  // namespace

glm::vec3 sky_direction(uint32_t cell, double u, double v) {
    const double row = cell / kSkyColumns + v;
    return toward(1 - 2 * row / kSkyRows, (cell % kSkyColumns + u) / kSkyColumns, 0);
}

SkyDirections::SkyDirections(std::shared_ptr<const Environment> environment)
    : environment_(std::move(environment)) {
    if (!environment_) return;
    const uint32_t width = environment_->width, height = environment_->height;
    block_ = (std::max(width, height) + kMostColumns - 1) / kMostColumns;
    columns_ = (width + block_ - 1) / block_;
    rows_ = (height + block_ - 1) / block_;
    block_sums_.assign(size_t{columns_} * rows_, 0);
    row_sums_.assign(rows_, 0);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            block_sums_[size_t{y / block_} * columns_ + x / block_] += weight(x, y);
    for (uint32_t row = 0; row < rows_; ++row) {
        double* sums = &block_sums_[size_t{row} * columns_];
        for (uint32_t i = 1; i < columns_; ++i) sums[i] += sums[i - 1];
        total_ += sums[columns_ - 1];
        row_sums_[row] = total_;
    }
}

/// Returns the luminance times the solid angle of a texel.
double SkyDirections::weight(uint32_t x, uint32_t y) const {
    const double step = M_PI / environment_->height;
    const double heights = std::cos(y * step) - std::cos((y + 1.0) * step);
    return luminance(glm::dvec3(environment_->texels[size_t{y} * environment_->width + x])) * heights * 2 *
           M_PI / environment_->width;
}

double SkyDirections::row_weight(uint32_t first_x, uint32_t end_x, uint32_t y) const {
    double sum = 0;
    for (uint32_t x = first_x; x < end_x; ++x) sum += weight(x, y);
    return sum;
}

glm::vec3 SkyDirections::draw_by_luminance(const glm::dvec2& point) const {
    const Environment& sky = *environment_;
    double u = point.x, v = point.y;
    const uint32_t row = take(row_sums_, v);
    const uint32_t column = take({&block_sums_[size_t{row} * columns_], columns_}, u);
    const uint32_t first_x = column * block_, end_x = std::min(first_x + block_, sky.width);
    const uint32_t first_y = row * block_, end_y = std::min(first_y + block_, sky.height);
    std::vector<double> running;
    const auto step = [&](double more) { running.push_back((running.empty() ? 0 : running.back()) + more); };
    for (uint32_t y = first_y; y < end_y; ++y) step(row_weight(first_x, end_x, y));
    const uint32_t y = first_y + take(running, v);
    running.clear();
    for (uint32_t x = first_x; x < end_x; ++x) step(weight(x, y));
    const uint32_t x = first_x + take(running, u);
    // Draw evenly over the solid angle of the texel; gi/shared/environment.h defines where it lies.
    const double slice = M_PI / sky.height;
    const double top = std::cos(y * slice), low = std::cos((y + 1.0) * slice);
    return toward(top + (low - top) * v, (x + u) / sky.width, sky.rotation);
}

glm::vec3 SkyDirections::draw_favoured(const glm::dvec2& point) const {
    double within = point.y;
    const uint32_t cell = take(favoured_, within);
    return sky_direction(cell, point.x, within);
}

void SkyDirections::favour(std::span<const float> importance) {
    favoured_.clear();
    if (dark() || importance.size() != kSkyCells) return;
    double sum = 0;
    for (uint32_t cell = 0; cell < kSkyCells; ++cell) {
        double bright = 0;
        if (importance[cell] > 0)
            for (uint32_t probe = 0; probe < kProbes * kProbes; ++probe)
                bright += luminance(glm::dvec3(environment_->radiance(sky_direction(
                    cell, (probe % kProbes + .5) / kProbes, (probe / kProbes + .5) / kProbes))));
        // The root, because what matters little to the whole picture matters to its dark parts.
        sum += bright * std::sqrt(std::max(importance[cell], 0.0f));
        favoured_.push_back(sum);
    }
    if (!(sum > 0) || !std::isfinite(sum)) favoured_.clear();
}

SkyDirections::Drawn SkyDirections::draw(const glm::dvec2& point) const {
    glm::vec3 direction;
    if (favoured_.empty())
        direction = draw_by_luminance(point);
    else if (point.y < kByLuminance)
        direction = draw_by_luminance({point.x, point.y / kByLuminance});
    else
        direction = draw_favoured({point.x, (point.y - kByLuminance) / (1 - kByLuminance)});
    const glm::vec3 radiance = environment_->radiance(direction);
    // Densities, 1/sr. Both ways may draw this direction: the balance heuristic (Veach & Guibas 1995).
    double density = luminance(glm::dvec3(radiance)) / total_;
    if (!favoured_.empty()) {
        const uint32_t cell = sky_cell(direction);
        const double share = (favoured_[cell] - (cell ? favoured_[cell - 1] : 0)) / favoured_.back();
        density = kByLuminance * density + (1 - kByLuminance) * share * kSkyCells / (4 * M_PI);
    }
    return {direction, density > 0 ? radiance * static_cast<float>(1 / density) : glm::vec3(0.0f)};
}

}  // namespace lucarne::gi
