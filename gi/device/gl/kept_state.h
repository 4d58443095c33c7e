#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace lucarne::gi {

/// Keeps the state of the current context that drawing triangles depends on, and restores it when it is
/// destroyed.
class KeptState {
 public:
    /// Sets what drawing into `targets` colour buffers of floats needs: no culling, no tests, every triangle
    /// filled, all channels written.
    explicit KeptState(uint32_t targets);
    ~KeptState();
    KeptState(const KeptState&) = delete;
    KeptState& operator=(const KeptState&) = delete;

 private:
    static constexpr uint32_t kMostTargets = 8;
    /// Of one draw buffer.
    struct Target {
        bool blend = false;
        std::array<int32_t, 6> how{};  ///< equations and factors, as kBlendState in kept_state.cpp lists them
        std::array<uint8_t, 4> mask{};
    };
    uint32_t targets_;
    std::array<Target, kMostTargets> kept_{};
    int32_t framebuffer_ = 0, vertex_array_ = 0, program_ = 0, polygon_mode_ = 0;
    std::array<float, 4> viewport_{};
    std::array<bool, 10> on_{};  ///< capabilities, as kCapabilities in kept_state.cpp lists them
    bool scissor_ = false;
};

}  // namespace lucarne::gi
