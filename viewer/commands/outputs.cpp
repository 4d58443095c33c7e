#include "viewer/commands/outputs.h"

#include <filesystem>

#include "io/core/file.h"

namespace lucarne::viewer {

Result<void> check_outputs(const std::vector<std::string>& outputs, bool overwrite,
                           const std::vector<std::string>& inputs) {
    for (const std::string& output : outputs) {
        if (output.empty()) continue;
        for (const std::string& input : inputs) {
            std::error_code neither_is_there;  // by device and inode, links followed
            if (std::filesystem::equivalent(output, input, neither_is_there))
                return bad_arguments(output, "is an input of this command, which would be lost",
                                     "choose another name for the output");
        }
        LUCARNE_TRY(check_output(output, overwrite));
    }
    return {};
}

}  // namespace lucarne::viewer
