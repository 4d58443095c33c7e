#include "gi/device/gl/shader_folder.h"

#include <optional>
#include <span>

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

void ShaderFolder::read() {
    texts_ = shader_texts();
    read_.clear();
    for (ShaderText& shader : texts_)
        if (auto text = whole_text(folder_ / shader.path)) shader.text = read_.emplace_back(std::move(*text));
}

}  // namespace lucarne::gi
