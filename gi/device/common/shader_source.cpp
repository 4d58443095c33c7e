#include "gi/device/common/shader_source.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace lucarne::gi {
namespace {

class Assembler {
 public:
    Assembler(const std::vector<ShaderText>& texts, ShaderLanguage language)
        : texts_(texts), language_(language) {}

    Result<void> add(std::string_view path) {
        if (std::find(source.files.begin(), source.files.end(), path) != source.files.end()) return {};
        const auto file =
            std::find_if(texts_.begin(), texts_.end(), [&](const auto& t) { return t.path == path; });
        if (file == texts_.end())
            return failed("shader " + std::string(path), "is not in this program",
                          "it is a fault of the program");
        const size_t index = source.files.size();
        source.files.emplace_back(path);
        add_place(1, index);
        size_t number = 1;
        for (std::string_view rest = file->text; !rest.empty(); ++number) {
            const size_t end = std::min(rest.find('\n'), rest.size() - 1);
            const std::string_view line = rest.substr(0, end + 1);
            rest.remove_prefix(end + 1);
            LUCARNE_TRY(add_line(line, index, number));
        }
        if (!source.text.ends_with('\n')) source.text += '\n';
        return {};
    }

    ShaderSource source;

 private:
    Result<void> add_line(std::string_view line, size_t file, size_t number) {
        const size_t at = line.find_first_not_of(" \t");
        if (at == std::string_view::npos || !line.substr(at).starts_with("#include")) {
            source.text += line;
            return {};
        }
        const size_t open = line.find('"'), close = line.find('"', open + 1);
        if (open != std::string_view::npos && close != std::string_view::npos)
            LUCARNE_TRY(add(line.substr(open + 1, close - open - 1)));
        add_place(number + 1, file);
        return {};
    }

    /// OpenCL compilers take file names in #line, GLSL takes file numbers.
    void add_place(size_t line, size_t file) {
        if (language_ == ShaderLanguage::opencl)
            source.text += fmt::format("#line {} \"{}\"\n", line, source.files[file]);
        else
            source.text += fmt::format("#line {} {}\n", line, file);
    }

    const std::vector<ShaderText>& texts_;
    ShaderLanguage language_;
};

}  // namespace

Result<ShaderSource> shader_source(std::string_view path, const Defines& defines,
                                   const std::vector<ShaderText>& texts, ShaderLanguage language) {
    Assembler assembler(texts, language);
    // Without contraction of floating-point operations the result is the same on every device that computes
    // in the same order.
    assembler.source.text =
        language == ShaderLanguage::glsl ? "#version 450 core\n" : "#pragma OPENCL FP_CONTRACT OFF\n";
    for (const auto& [name, value] : defines)
        assembler.source.text += fmt::format("#define {} {}\n", name, value);
    LUCARNE_TRY(assembler.add(path));
    return std::move(assembler.source);
}

std::string readable_message(std::string_view log, const std::vector<std::string>& files) {
    std::string first;
    for (std::string_view rest = log; !rest.empty();) {
        const size_t end = std::min(rest.find('\n'), rest.size());
        const std::string line(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (first.empty()) first = line;
        unsigned file = 0, number = 0;
        int mesa = 0, nvidia = 0;  // characters before the message; 0 if the line has another format
        if (std::sscanf(line.c_str(), "%u:%u(%*u): %n", &file, &number, &mesa) < 2 || !mesa)
            std::sscanf(line.c_str(), "%u(%u) : %n", &file, &number, &nvidia);
        const auto start = static_cast<size_t>(std::max(mesa, nvidia));
        if (start == 0 || line.find("error", start) == std::string::npos) continue;
        return fmt::format("{}:{}: {}", file < files.size() ? files[file] : std::to_string(file), number,
                           line.substr(start));
    }
    return first.empty() ? "the compiler gave no reason" : first;
}

}  // namespace lucarne::gi
