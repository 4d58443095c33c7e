#include "gi/device/gl/device.h"

#include <chrono>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "gi/device/cl/cl_device.h"
#include "gi/device/common/memory_budget.h"
#include "gi/device/common/shader_files.h"
#include "gi/device/common/shader_source.h"
#include "gi/device/gl/context_watch.h"
#include "gi/device/gl/egl.h"
#include "io/core/log.h"

namespace lucarne::gi {
namespace {

constexpr const char* kMemoryTodo = "lower the number of points or the picture's size";

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

#ifndef NDEBUG
void on_debug_message(GLenum, GLenum type, GLuint, GLenum severity, GLsizei, const GLchar* text,
                      const void*) {
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH) log::warn("OpenGL: {}", text);
}
#endif

void clear_errors() {
    while (glGetError() != GL_NO_ERROR) {
    }
}

/// The stage that a shader's name tells.
GLenum stage_of(std::string_view path) {
    if (path.ends_with(".vert")) return GL_VERTEX_SHADER;
    if (path.ends_with(".geom")) return GL_GEOMETRY_SHADER;
    return path.ends_with(".frag") ? GL_FRAGMENT_SHADER : GL_COMPUTE_SHADER;
}

/// The shaders of a program, with their includes.
struct ProgramSource {
    std::vector<std::string> paths;
    std::vector<ShaderSource> stages;

    static Result<ProgramSource> of(const std::vector<std::string>& paths, const Defines& defines,
                                    const std::vector<ShaderText>& texts) {
        ProgramSource source{paths, {}};
        for (const std::string& path : paths) {
            LUCARNE_ASSIGN(ShaderSource stage, shader_source(path, defines, texts));
            source.stages.push_back(std::move(stage));
        }
        return source;
    }
    std::string text() const {
        std::string all;
        for (const ShaderSource& stage : stages) all += stage.text;
        return all;
    }
};

template <class Get, class GetLog>
std::string info_log(GLuint id, const Get& get, const GetLog& get_log) {
    GLint length = 0;
    get(id, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
    if (length > 0) get_log(id, length, &length, log.data());
    log.resize(static_cast<size_t>(std::max(length, 0)));
    return log;
}

/// Compiles and links a program and returns its name. Errors carry the compiler's first message.
Result<GLuint> compile(const ProgramSource& source) {
    const auto wrong = [](const std::string& path, const std::string& log, const ShaderSource& stage) {
        return failed("shader " + path, readable_message(log, stage.files),
                      "the driver is " + gl_string(GL_VERSION));
    };
    const GLuint id = glCreateProgram();
    for (size_t i = 0; i < source.stages.size(); ++i) {
        const GLuint shader = glCreateShader(stage_of(source.paths[i]));
        const char* text = source.stages[i].text.c_str();
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        GLint compiled = GL_FALSE;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
        const std::string log = compiled ? "" : info_log(shader, glGetShaderiv, glGetShaderInfoLog);
        glAttachShader(id, shader);
        glDeleteShader(shader);  // when the program lets it go
        if (compiled) continue;
        glDeleteProgram(id);
        return wrong(source.paths[i], log, source.stages[i]);
    }
    glLinkProgram(id);
    GLint linked = GL_FALSE;
    glGetProgramiv(id, GL_LINK_STATUS, &linked);
    if (linked) return id;
    const std::string log = info_log(id, glGetProgramiv, glGetProgramInfoLog);
    glDeleteProgram(id);
    return wrong(source.paths.front(), log, source.stages.front());
}

/// A program and the source it was compiled from.
struct CompiledProgram {
    std::string text;
    std::unique_ptr<ProgramUniforms> program;
};

}  // namespace

struct Device::State {
    std::unique_ptr<HeadlessContext> context;  // empty if the context is a window's; destroyed last
    DeviceInfo info;
    MemoryBudget memory;
    bool native_passes = false;
    std::map<std::tuple<std::vector<std::string>, Defines>, CompiledProgram> programs;  ///< by paths
    ShaderFiles shaders;
    std::string mistake;
    ContextWatch watch;
    std::unique_ptr<ClDevice> opencl;  // null until it is first asked for; uses the members above
};

Device::Device() : state_(std::make_unique<State>()) {}
Device::~Device() {
    state_->opencl.reset();
    state_->programs.clear();
}

Result<std::unique_ptr<Device>> Device::headless() {
    LUCARNE_ASSIGN(auto context, HeadlessContext::create());
    LUCARNE_ASSIGN(auto device, current());
    device->state_->context = std::move(context);
    return device;
}

Result<std::unique_ptr<Device>> Device::current() {
    if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 45)
        return failed("OpenGL", "no usable device: it has only " + gl_string(GL_VERSION),
                      "OpenGL 4.5 is needed");
    std::unique_ptr<Device> device(new Device);
    DeviceInfo& info = device->state_->info;
    info.vendor = gl_string(GL_VENDOR);
    info.renderer = gl_string(GL_RENDERER);
    info.version = gl_string(GL_VERSION);
    for (const char* name : {"llvmpipe", "softpipe", "SWR", "Software"})
        info.software = info.software || info.renderer.find(name) != std::string::npos;
    GLint64 bytes = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    info.max_texel_bytes = uint64_t{16} * static_cast<uint64_t>(texels);
    info.max_buffer_bytes = std::min(static_cast<uint64_t>(bytes), info.max_texel_bytes);
    const char* native = std::getenv("LUCARNE_NATIVE");
    device->use_native_passes(!native || std::string_view(native) != "0");
    if (const char* folder = std::getenv("LUCARNE_SHADERS")) device->use_shader_folder(folder);
#ifndef NDEBUG
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_debug_message, nullptr);
#endif
    return device;
}

const DeviceInfo& Device::info() const {
    return state_->info;
}
bool Device::native_passes() const {
    return state_->native_passes;
}
void Device::use_native_passes(bool use) {
    state_->native_passes = use && state_->info.software;
}
void Device::set_memory_cap(uint64_t bytes) {
    state_->memory.set_cap(bytes);
}
uint64_t Device::memory_cap() const {
    return state_->memory.cap();
}
uint64_t Device::memory_used() const {
    return state_->memory.used();
}
bool Device::take_refusal() {
    return state_->memory.take_refusal();
}
void Device::finish() {
    glFinish();
    finish_opencl();
}
void Device::finish_opencl() {
    // A failure is a loss, which check() reports; any other error comes from the call that failed.
    if (state_->opencl && state_->opencl->is_busy()) static_cast<void>(state_->opencl->finish());
}
Result<void> Device::check() {
    if (!state_->mistake.empty())
        return failed(std::exchange(state_->mistake, {}), "is not declared", "it is a fault of the program");
    if (!state_->watch.lost()) return {};
    return failed("graphics device", state_->watch.reason(), "see that its driver is up to date");
}
void Device::lose_after(uint32_t checks) {
    state_->watch.lose_after(checks);
}

Result<Buffer> Device::buffer(size_t bytes, std::string_view what) {
    return make(bytes, state_->info.max_buffer_bytes, what);
}
Result<Buffer> Device::texels(size_t bytes, std::string_view what) {
    return make(bytes, state_->info.max_texel_bytes, what);
}

Result<Buffer> Device::make(size_t bytes, uint64_t most, std::string_view what) {
    constexpr size_t kGrain = 16;  // a storage block ends on a vec4
    const std::string name(what);
    if (bytes > most)
        return failed(name,
                      fmt::format("{} MiB are more than a buffer of {} holds ({} MiB)", bytes >> 20,
                                  state_->info.renderer, most >> 20),
                      kMemoryTodo);
    bytes = std::max((bytes + kGrain - 1) / kGrain * kGrain, kGrain);
    LUCARNE_TRY(state_->memory.take(bytes, what));
    clear_errors();
    Buffer made;
    glCreateBuffers(1, &made.id_);
    // Buffers that the host may map could be put in slower memory, so those of GPUs are not.
    const GLbitfield mapped = state_->info.software ? GL_MAP_READ_BIT | GL_MAP_WRITE_BIT : 0;
    glNamedBufferStorage(made.id_, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT | mapped);
    if (glGetError() != GL_NO_ERROR) {  // `made` returns nothing to the budget: its device_ is null
        state_->memory.give_back(bytes);
        return failed(name, fmt::format("the device has no {} KiB of memory left", (bytes + 1023) >> 10),
                      kMemoryTodo);
    }
    made.device_ = this;
    made.bytes_ = bytes;
    return made;
}

Result<void> Device::take_memory(uint64_t bytes, std::string_view what) {
    return state_->memory.take(bytes, what);
}
void Device::give_back_memory(uint64_t bytes) {
    state_->memory.give_back(bytes);
}

Result<void> Device::reserve(Buffer& target, size_t bytes, std::string_view what) {
    if (target && target.bytes() >= bytes) return {};
    target = Buffer();  // free the old buffer first, so that both never count together
    LUCARNE_ASSIGN(target, buffer(bytes, what));
    return {};
}

Result<ClDevice*> Device::opencl() {
    State& state = *state_;
    if (state.opencl) return state.opencl.get();
    auto report_loss = [&state](std::string why) { state.watch.report_loss(std::move(why)); };
    LUCARNE_ASSIGN(state.opencl, ClDevice::open({state.memory, state.shaders, std::move(report_loss)}));
    return state.opencl.get();
}

std::unique_ptr<ProgramUniforms> Device::wrapped(const std::vector<std::string>& paths,
                                                 const std::string& text, uint32_t id) {
    if (paths.size() == 1) return std::unique_ptr<Program>(new Program(*this, paths.front(), text, id));
    return std::unique_ptr<RasterProgram>(new RasterProgram(*this, paths.front(), text, id));
}

Result<const ProgramUniforms*> Device::compiled(std::vector<std::string> paths, const Defines& defines) {
    std::tuple<std::vector<std::string>, Defines> key(std::move(paths), defines);
    if (const auto found = state_->programs.find(key); found != state_->programs.end())
        return found->second.program.get();
    const auto make = [&](const std::vector<ShaderText>& texts) -> Result<CompiledProgram> {
        LUCARNE_ASSIGN(const auto source, ProgramSource::of(std::get<0>(key), defines, texts));
        LUCARNE_ASSIGN(const GLuint id, compile(source));
        return CompiledProgram{source.text(), wrapped(std::get<0>(key), source.text(), id)};
    };
    auto made = make(state_->shaders.texts());
    if (!made && state_->shaders.from_folder()) {
        state_->shaders.note_problem(made.error());
        made = make(state_->shaders.embedded());
    }
    if (!made) return tl::make_unexpected(std::move(made).error());
    return state_->programs.emplace(std::move(key), std::move(*made)).first->second.program.get();
}

Result<const Program*> Device::program(std::string_view path, const Defines& defines) {
    LUCARNE_ASSIGN(const ProgramUniforms* found, compiled({std::string(path)}, defines));
    return static_cast<const Program*>(found);
}

Result<const RasterProgram*> Device::raster_program(const RasterShaders& shaders, const Defines& defines) {
    LUCARNE_ASSIGN(
        const ProgramUniforms* found,
        compiled({std::string(shaders.vertex), std::string(shaders.geometry), std::string(shaders.fragment)},
                 defines));
    return static_cast<const RasterProgram*>(found);
}

void Device::add_shader(std::string path, std::string text) {
    state_->shaders.add(std::move(path), std::move(text));
}

void Device::use_shader_folder(const std::filesystem::path& folder) {
    state_->shaders.use_folder(folder);
    state_->programs.clear();
    if (state_->opencl) state_->opencl->reload_programs();
}

void Device::reload_shaders() {
    if (!state_->shaders.from_folder()) return;
    state_->shaders.read_again();
    for (auto& [key, program] : state_->programs) {
        const auto& [paths, defines] = key;
        auto source = ProgramSource::of(paths, defines, state_->shaders.texts());
        if (source && source->text() == program.text) continue;
        const Result<GLuint> id = source ? compile(*source) : tl::make_unexpected(std::move(source).error());
        if (!id) {
            state_->shaders.note_problem(id.error());
            continue;
        }
        program.text = source->text();
        program.program = wrapped(paths, program.text, *id);
    }
    if (state_->opencl) state_->opencl->reload_programs();
}

const std::string& Device::shader_problem() const {
    return state_->shaders.problem();
}

void Device::note_unknown_uniform(std::string_view path, std::string_view uniform) {
    const std::string what = fmt::format("shader {}: uniform {}", path, uniform);
    // Whoever edits shaders may remove a uniform for a while.
    if (state_->shaders.from_folder())
        state_->shaders.note_problem(Error{ErrorKind::failed, what, "is not declared", ""});
    else if (state_->mistake.empty())
        state_->mistake = what;
}

Buffer::Buffer(Buffer&& other) noexcept {
    *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    std::swap(textures_, other.textures_);
    return *this;
}

Buffer::~Buffer() {
    for (const uint32_t texture : textures_)
        if (texture) glDeleteTextures(1, &texture);
    if (id_) glDeleteBuffers(1, &id_);
    if (device_) device_->state_->memory.give_back(bytes_);
}

void Buffer::bind(uint32_t binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_);
}

void Buffer::bind_texels(uint32_t unit, TexelView view) const {
    uint32_t& texture = textures_[static_cast<size_t>(view)];
    if (!texture) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &texture);
        constexpr GLenum kFormats[] = {GL_R32UI, GL_RG32UI, GL_RGBA32UI, GL_RGBA32F};
        glTextureBuffer(texture, kFormats[static_cast<size_t>(view)], id_);
    }
    glBindTextureUnit(unit, texture);
}

void Buffer::upload(size_t offset, std::span<const std::byte> data) {
    if (offset > bytes_ || data.size() > bytes_ - offset)
        throw std::logic_error("upload beyond the buffer's end");
    if (data.empty()) return;
    glNamedBufferSubData(id_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(data.size()),
                         data.data());
}

void Buffer::download(size_t offset, std::span<std::byte> out) const {
    if (offset > bytes_ || out.size() > bytes_ - offset)
        throw std::logic_error("download beyond the buffer's end");
    if (out.empty()) return;
    glGetNamedBufferSubData(id_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(out.size()),
                            out.data());
}

void Buffer::copy_from(const Buffer& from, size_t from_offset, size_t offset, size_t bytes) {
    if (offset > bytes_ || bytes > bytes_ - offset || from_offset > from.bytes_ ||
        bytes > from.bytes_ - from_offset)
        throw std::logic_error("copy beyond a buffer's end");
    if (bytes == 0) return;
    glCopyNamedBufferSubData(from.id_, id_, static_cast<GLintptr>(from_offset), static_cast<GLintptr>(offset),
                             static_cast<GLsizeiptr>(bytes));
}

void Buffer::clear(uint32_t word) {
    if (id_) glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

Result<MappedBuffer> Buffer::map() const {
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_WRITE_BIT;
    void* data = id_ ? glMapNamedBufferRange(id_, 0, static_cast<GLsizeiptr>(bytes_), kAccess) : nullptr;
    if (!data) return failed("graphics device", "the driver does not map a buffer", "set LUCARNE_NATIVE=0");
    return MappedBuffer(id_, static_cast<std::byte*>(data), bytes_);
}

MappedBuffer::MappedBuffer(MappedBuffer&& other) noexcept
    : id_(std::exchange(other.id_, 0)), data_(other.data_), bytes_(other.bytes_) {}

MappedBuffer::~MappedBuffer() {
    if (id_) glUnmapNamedBuffer(id_);
}

}  // namespace lucarne::gi
