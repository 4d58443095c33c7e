#include "tests/added_engine/opencl/opencl.h"

#include "gi/device/cl/cl_device.h"
#include "gi/gl_frame.h"
#include "gi/host_frame.h"

namespace lucarne::gi {
namespace {

constexpr EngineInfo kInfo{
    .name = "opencl", .label = "OpenCL", .description = "one colour, by OpenCL", .needs = {.opencl = true}};

constexpr const char* kFill =
    "kernel void fill(global float4* radiance, uint pixels) {\n"
    "    if (get_global_id(0) < pixels) radiance[get_global_id(0)] = (float4)(0.25f, 0.5f, 1.0f, 1.0f);\n"
    "}\n";

class OpenClEngine final : public Engine {
 public:
    const EngineInfo& info() const override { return kInfo; }
    std::vector<std::pair<std::string, double>> stats() const override { return {}; }

 protected:
    Result<void> prepare(Frame& frame) override {
        if (opencl_) return {};
        LUCARNE_ASSIGN(opencl_, frame.gl.device.opencl());
        frame.gl.device.add_shader("fill.cl", kFill);
        if (const auto calls = opencl_losses().next()) opencl_->lose_after(*calls);
        return {};
    }
    Result<void> render(Frame& frame) override {
        const uint32_t pixels = frame.camera.width * frame.camera.height;
        std::vector<glm::vec4> radiance(pixels);
        LUCARNE_TRY(opencl_->reserve(pixels_, pixels * sizeof(glm::vec4), "radiance"));
        LUCARNE_ASSIGN(const ClKernel* fill, opencl_->kernel("fill.cl", "fill"));
        LUCARNE_TRY(fill->run(ClRange(pixels), pixels_, pixels));
        LUCARNE_TRY(pixels_.download(0, std::as_writable_bytes(std::span(radiance))));
        upload_radiance(frame, radiance);
        return {};
    }

 private:
    ClDevice* opencl_ = nullptr;
    ClBuffer pixels_;
};

}  // namespace

EngineEntry opencl_engine() {
    return {kInfo, []() -> std::unique_ptr<Engine> { return std::make_unique<OpenClEngine>(); }};
}

LossPlan& opencl_losses() {
    static LossPlan plan("");
    return plan;
}

}  // namespace lucarne::gi
