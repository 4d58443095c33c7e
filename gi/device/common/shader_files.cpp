#include "gi/device/common/shader_files.h"

#include <algorithm>
#include <span>
#include <utility>

#include "io/core/log.h"
#include "io/files/file.h"

namespace lucarne::gi {
namespace {

constexpr uint64_t kMostBytes = uint64_t{1} << 20;  ///< of a file; ours have a few thousand

std::optional<std::string> whole_text(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    if (!file || file->size() > kMostBytes) return std::nullopt;
    std::string text(file->size(), '\0');
    if (!file->read_at(0, std::as_writable_bytes(std::span(text)))) return std::nullopt;
    return text;
}

}  // namespace

void ShaderFiles::add(std::string path, std::string text) {
    const auto found = std::ranges::find(embedded_, path, &ShaderText::path);
    const std::string_view kept = added_.emplace_back(std::move(text));
    if (found != embedded_.end())
        found->text = kept;
    else
        embedded_.push_back({added_.emplace_back(std::move(path)), kept});
    if (folder_) read();
}

void ShaderFiles::use_folder(std::filesystem::path folder) {
    folder_ = std::move(folder);
    read_again();
}

void ShaderFiles::read_again() {
    if (!folder_) return;
    problem_.clear();
    read();
}

void ShaderFiles::read() {
    texts_ = embedded_;
    read_.clear();
    for (ShaderText& shader : texts_)
        if (auto text = whole_text(*folder_ / shader.path))
            shader.text = read_.emplace_back(std::move(*text));
}

void ShaderFiles::note_problem(const Error& error) {
    log::warn("{}", error.line());
    if (problem_.empty()) problem_ = error.line();
}

}  // namespace lucarne::gi
