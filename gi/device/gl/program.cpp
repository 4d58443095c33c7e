#include <algorithm>
#include <cctype>
#include <stdexcept>

#include <epoxy/gl.h>

#include "gi/device/gl/device.h"

namespace lucarne::gi {
namespace {

/// The uniform of gi/shared/many_threads.glsl.
constexpr const char* kThreadsARow = "threads_a_row";

constexpr GLbitfield kAllReads = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                                 GL_BUFFER_UPDATE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT;

}  // namespace

std::set<std::string, std::less<>> declared_uniforms(std::string_view text) {
    std::set<std::string, std::less<>> names;
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    std::string plain;  // the text without // comments
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view line = text.substr(at, end - at);
        plain.append(line.substr(0, std::min(line.find("//"), line.size()))).push_back('\n');
        at = end + 1;
    }
    constexpr std::string_view kWord = "uniform";
    for (size_t at = plain.find(kWord); at != plain.npos; at = plain.find(kWord, at)) {
        const bool whole = (at == 0 || !is_word(plain[at - 1])) && !is_word(plain[at + kWord.size()]);
        at += kWord.size();
        if (!whole) continue;
        // "Light lights[4], other;": the last word before a comma, a bracket or the end is a name.
        std::string word;
        bool in_brackets = false;
        for (; at < plain.size(); ++at) {
            const char c = plain[at];
            if (is_word(c) && !in_brackets) {
                if (at > 0 && !is_word(plain[at - 1])) word.clear();
                word.push_back(c);
            }
            in_brackets = c == '[' || (in_brackets && c != ']');
            if (c != ',' && c != ';') continue;
            names.insert(word);
            if (c == ';') break;
        }
    }
    return names;
}

ProgramUniforms::ProgramUniforms(Device& device, std::string_view path, std::string_view text, uint32_t id)
    : device_(&device), path_(path), id_(id), declared_(declared_uniforms(text)) {
    GLint uniforms = 0, longest = 0;
    glGetProgramiv(id_, GL_ACTIVE_UNIFORMS, &uniforms);
    glGetProgramiv(id_, GL_ACTIVE_UNIFORM_MAX_LENGTH, &longest);
    std::string name(static_cast<size_t>(longest) + 1, '\0');
    for (GLint i = 0; i < uniforms; ++i) {
        GLsizei length = 0;
        GLint count = 0;
        GLenum type = 0;
        glGetActiveUniform(id_, static_cast<GLuint>(i), static_cast<GLsizei>(name.size()), &length, &count,
                           &type, name.data());
        std::string key = name.substr(0, static_cast<size_t>(length));
        const GLint location = glGetUniformLocation(id_, key.c_str());
        if (key.ends_with("[0]")) key.resize(key.size() - 3);
        uniforms_.emplace(std::move(key), Uniform{location, type});
    }
}

ProgramUniforms::~ProgramUniforms() {
    glDeleteProgram(id_);
}

const ProgramUniforms::Uniform* ProgramUniforms::find(std::string_view uniform) const {
    const auto found = uniforms_.find(uniform);
    if (found != uniforms_.end()) return &found->second;
    const auto name = uniform.substr(0, uniform.find_first_of(".["));
    if (name != kThreadsARow && !declared_.contains(name)) device_->note_unknown_uniform(path_, name);
    return nullptr;
}

void ProgramUniforms::set(std::string_view uniform, int32_t value) const {
    if (const auto* u = find(uniform)) glProgramUniform1i(id_, u->location, value);
}
void ProgramUniforms::set(std::string_view uniform, uint32_t value) const {
    if (const auto* u = find(uniform)) glProgramUniform1ui(id_, u->location, value);
}
void ProgramUniforms::set(std::string_view uniform, float value) const {
    if (const auto* u = find(uniform)) glProgramUniform1f(id_, u->location, value);
}

void ProgramUniforms::set_block(std::string_view uniform, std::span<const float> values) const {
    const auto* u = find(uniform);
    if (!u) return;
    const auto count = static_cast<GLsizei>(values.size());
    switch (u->type) {
        case GL_FLOAT:
            glProgramUniform1fv(id_, u->location, count, values.data());
            break;
        case GL_FLOAT_VEC2:
            glProgramUniform2fv(id_, u->location, count / 2, values.data());
            break;
        case GL_FLOAT_VEC3:
            glProgramUniform3fv(id_, u->location, count / 3, values.data());
            break;
        case GL_FLOAT_VEC4:
            glProgramUniform4fv(id_, u->location, count / 4, values.data());
            break;
        default:
            throw std::logic_error("set_block: not a float uniform: " + std::string(uniform));
    }
}

Program::Program(Device& device, std::string_view path, std::string_view text, uint32_t id)
    : ProgramUniforms(device, path, text, id) {
    GLint local[3] = {1, 1, 1};
    glGetProgramiv(id, GL_COMPUTE_WORK_GROUP_SIZE, local);
    for (int i = 0; i < 3; ++i) local_[i] = static_cast<uint32_t>(local[i]);
}

void Program::dispatch(uint32_t x, uint32_t y, uint32_t z) const {
    const uint32_t wanted[3] = {x, y, z};
    GLuint groups[3], rows = 1;
    for (GLuint i = 0; i < 3; ++i) {
        if (wanted[i] == 0) return;
        GLint most = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, i, &most);
        groups[i] = (wanted[i] - 1) / local_[i] + 1;
        if (groups[i] <= static_cast<GLuint>(most)) continue;
        if (i > 0 || y * z != 1 || !find(kThreadsARow))
            throw std::logic_error("dispatch: more groups than OpenGL takes");
        rows = (groups[0] - 1) / static_cast<GLuint>(most) + 1;
        groups[0] = (groups[0] - 1) / rows + 1;
    }
    if (rows > 1) {
        groups[1] = rows;
        set(kThreadsARow, uint32_t{groups[0] * local_[0]});
    }
    glUseProgram(id());
    glDispatchCompute(groups[0], groups[1], groups[2]);
    glMemoryBarrier(kAllReads);
}

void Program::dispatch_indirect(const Buffer& groups, size_t offset) const {
    glUseProgram(id());
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, groups.id());
    glDispatchComputeIndirect(static_cast<GLintptr>(offset));
    glMemoryBarrier(kAllReads);
}

}  // namespace lucarne::gi
