#include "gi/device/cl/cl_device.h"

#include <utility>

namespace lucarne::gi {

Result<std::unique_ptr<ClDevice>> ClDevice::open(ClHost host) {
    LUCARNE_ASSIGN(auto context, ClContext::open(host.memory, std::move(host.report_loss)));
    return std::unique_ptr<ClDevice>(new ClDevice(host.shaders, std::move(context)));
}

Result<ClBuffer> ClDevice::buffer(size_t bytes, std::string_view what) {
    return ClBuffer::make(*context_, bytes, what);
}

Result<void> ClDevice::reserve(ClBuffer& target, size_t bytes, std::string_view what) {
    if (target && target.bytes() >= bytes) return {};
    target = ClBuffer();  // free the old buffer first, so that both never count together
    LUCARNE_ASSIGN(target, buffer(bytes, what));
    return {};
}

Result<void> ClDevice::lend(ClBuffer& target, std::span<const std::byte> data,
                            std::shared_ptr<const void> owner, std::string_view what) {
    target = ClBuffer();
    if (data.empty()) return failed(std::string(what), "there is nothing to send to the OpenCL device");
    if (info().is_gpu) {
        LUCARNE_ASSIGN(target, buffer(data.size(), what));
        return target.upload(0, data);
    }
    LUCARNE_ASSIGN(target, ClBuffer::lend(*context_, data, std::move(owner), what));
    return {};
}

Result<void> ClDevice::build(ClProgram& program, const Key& key, const std::vector<ShaderText>& texts) {
    const auto& [path, defines] = key;
    LUCARNE_ASSIGN(ShaderSource source, shader_source(path, defines, texts, ShaderLanguage::opencl));
    if (source.text == program.text()) return {};
    LUCARNE_TRY(program.compile(std::move(source.text)));
    ++programs_built_;
    return {};
}

Result<ClProgram*> ClDevice::program(const Key& key) {
    if (const auto found = programs_.find(key); found != programs_.end()) return found->second.get();
    auto made = std::make_unique<ClProgram>(*context_, std::get<std::string>(key));
    auto built = build(*made, key, shaders_.texts());
    if (!built && shaders_.from_folder()) {
        shaders_.note_problem(built.error());
        built = build(*made, key, shaders_.embedded());
    }
    if (!built) return tl::make_unexpected(std::move(built).error());
    return programs_.emplace(key, std::move(made)).first->second.get();
}

Result<const ClKernel*> ClDevice::kernel(std::string_view path, std::string_view name,
                                         const Defines& defines) {
    LUCARNE_TRY(context_->usable());
    const Key key(path, defines);
    LUCARNE_ASSIGN(ClProgram* const found, program(key));
    auto kernel = found->kernel(name);
    if (kernel || !shaders_.from_folder()) return kernel;
    // The file on disk may lack a function that the embedded one has.
    shaders_.note_problem(kernel.error());
    LUCARNE_TRY(build(*found, key, shaders_.embedded()));
    return found->kernel(name);
}

void ClDevice::reload_programs() {
    if (!context_->usable()) return;
    for (auto& [key, program] : programs_)
        if (const auto built = build(*program, key, shaders_.texts()); !built)
            shaders_.note_problem(built.error());
}

}  // namespace lucarne::gi
