#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec4.hpp>

#include "gi/device/cl/cl_device.h"
#include "gi/frame.h"
#include "gi/steps.h"

namespace lucarne::gi::paint {

inline constexpr uint32_t kBands = 8;

/// What the colours are made from. Equal bases give equal colours.
struct Basis {
    uint64_t settings = 0;                ///< SceneRevisions::settings
    std::optional<glm::dvec3> mean = {};  ///< of the scan, if it is known
    bool operator==(const Basis&) const = default;
};

/// The colours of eight bands of a picture, from top to bottom. An OpenCL kernel makes one a step.
class Bands {
 public:
    /// Takes the device, and starts again if the basis is another. Errors: no device, its memory, a kernel
    /// that does not compile.
    Result<void> prepare(Frame& frame, const Basis& basis);
    /// Takes as many steps as the budget allows. Errors: the device failed.
    Result<void> run(Frame& frame, const StepBudget& budget);
    /// The colours that were finished last; none at first.
    const std::optional<std::array<glm::vec4, kBands>>& finished() const { return finished_; }
    bool running() const { return runner_.running(); }

 private:
    Result<StepResult> paint(const Frame& frame, uint32_t band);
    Result<StepResult> show();

    ClDevice* opencl_ = nullptr;
    const ClKernel* kernel_ = nullptr;
    ClBuffer colours_;
    std::optional<Basis> basis_;
    StepRunner<const Frame> runner_;
    std::optional<std::array<glm::vec4, kBands>> finished_;
};

}  // namespace lucarne::gi::paint
