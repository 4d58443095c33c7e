#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>

#include "gi/shared/brdf.h"

namespace lucarne::gi {

/// The share of even light that a lobe with ks = 1 reflects, for any direction of the light that leaves: the
/// integral of specular_brdf() times the cosine.
class LobeAlbedo {
 public:
    explicit LobeAlbedo(float exponent);
    /// `cosine`: of the angle between the normal and the direction in which the light leaves; or, since
    /// lobes are reciprocal, arrives, and what leaves in all directions is asked for.
    float at(float cosine) const;
    /// Returns the share of even light that leaves in all directions.
    float mean() const { return mean_; }

 private:
    static constexpr uint32_t kSteps = 32;
    std::array<float, kSteps + 1> values_{};
    float mean_ = 0;
};

/// Those of the lobes of some materials.
class LobeAlbedos {
 public:
    /// Adds the lobes of these materials.
    void take(std::span<const Material> materials);
    bool empty() const { return by_exponent_.empty(); }
    /// Returns the one of a lobe's exponent; null if no material has it.
    const LobeAlbedo* find(float exponent) const;

 private:
    std::map<float, LobeAlbedo> by_exponent_;
};

}  // namespace lucarne::gi
