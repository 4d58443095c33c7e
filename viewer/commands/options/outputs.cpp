#include "viewer/commands/options/outputs.h"

#include <filesystem>

#include "io/files/file.h"

namespace lucarne::viewer {
namespace {

/// Returns the path that writing the output replaces: for a link the link itself, in its resolved folder.
std::filesystem::path name_of(const std::filesystem::path& output) {
    std::error_code unknown;
    const auto folder =
        std::filesystem::weakly_canonical(std::filesystem::absolute(output, unknown).parent_path(), unknown);
    return folder / output.filename();
}

}  // namespace

Result<void> check_outputs(const std::vector<std::string>& outputs, bool overwrite,
                           const std::vector<std::string>& inputs) {
    for (size_t i = 0; i < outputs.size(); ++i) {
        const std::string& output = outputs[i];
        if (output.empty()) continue;
        for (size_t other = 0; other < i; ++other)
            if (!outputs[other].empty() && name_of(output) == name_of(outputs[other]))
                return bad_arguments(output, "would be written twice by this command",
                                     "choose another name for one of the outputs");
        for (const std::string& input : inputs) {
            std::error_code neither_is_there;  // equivalent() compares device and inode and follows links
            if (std::filesystem::equivalent(output, input, neither_is_there))
                return bad_arguments(output, "is an input of this command, which would be lost",
                                     "choose another name for the output");
        }
        LUCARNE_TRY(check_output(output, overwrite));
    }
    return {};
}

}  // namespace lucarne::viewer
