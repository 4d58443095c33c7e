// What an engine computes in advance, on a thread of its own over host data, and keeps beside the cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gi/bake/host_cut.h"
#include "gi/options.h"
#include "gi/scene/environment.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "gi/steps.h"

namespace lucarne::gi {

/// What a precomputation reads. It does not change while it is read.
struct BakeInput {
    uint64_t source = 0;  ///< octree::SourceIdentity::content; 0: the source has none
    HostCut cut;
    std::vector<Material> materials;
    std::vector<Light> lights;  ///< in the cut's local frame
    std::shared_ptr<const Environment> environment;
    EngineSettings settings;
    std::optional<Bounds> lighting_region;  ///< Scene::lighting_region in the cut's local frame, m
    /// Whether pictures show what is usable meanwhile. The result does not depend on it.
    bool is_shown = true;
};

/// What an engine reads of a precomputation, finished or not. It never changes; engines know their own.
class Bake {
 public:
    virtual ~Bake() = default;
};

/// Named pieces of a bake file.
using BakeSections = std::map<std::string, std::vector<std::byte>>;

/// Computes a Bake in steps. All functions are called on one thread.
class Precomputation {
 public:
    virtual ~Precomputation() = default;
    /// Continues from what save() returned. Errors: the sections are not such. Every byte of them may be
    /// wrong.
    virtual Result<void> restore(const BakeInput& input, const BakeSections& sections) = 0;
    /// Returns the steps that are left, at least one unless share() is 1.
    virtual std::vector<Step<const BakeInput>> steps(const BakeInput& input) = 0;
    /// The finished share, 0..1.
    virtual double share() const = 0;
    /// Returns what is usable so far; null if nothing is.
    virtual std::shared_ptr<const Bake> snapshot() const = 0;
    virtual BakeSections save() const = 0;
};

/// What a precomputation takes, about.
struct BakeCost {
    double cpu_seconds = 0;
    uint64_t memory_bytes = 0;  ///< while it runs
    uint64_t file_bytes = 0;
};

/// How an engine precomputes: a constant in the engine's folder (EngineInfo::precomputes).
struct Precomputes {
    std::unique_ptr<Precomputation> (*make)() = nullptr;
    uint32_t version = 1;  ///< of what save() writes; another version is not restored
    /// What the result depends on, beside the places, areas and normals of the surfels.
    bool colours = false, materials = false, lights = false, environment = false, lighting_region = false;
    std::span<const OptionInfo* const> options = {};
    /// Estimates the cost for so many surfels; null: unknown.
    BakeCost (*cost)(const EngineSettings& settings, uint64_t surfels) = nullptr;
};

/// Returns a hash of all that the result of an engine's precomputation depends on.
uint64_t bake_key(std::string_view engine, const Precomputes& how, const BakeInput& input);

}  // namespace lucarne::gi
