#include "io/files/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "io/core/interrupt.h"

namespace lucarne {

Result<TemporaryFolder> TemporaryFolder::create() {
    std::error_code code;
    const auto base = std::filesystem::temp_directory_path(code);
    if (code) return failed("temporary folder", code.message(), "set TMPDIR to a folder that can be written");
    std::string name = (base / "lucarne-XXXXXX").string();
    if (!::mkdtemp(name.data()))
        return failed(base.string(), std::strerror(errno), "set TMPDIR to a folder that can be written");
    at_interrupt(name, [name] {
        std::error_code ignored;
        std::filesystem::remove_all(name, ignored);
        return std::string();
    });
    return TemporaryFolder(name);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code code;
    if (path_.empty()) return;
    std::filesystem::remove_all(path_, code);
    forget_interrupt(path_);
}

}  // namespace lucarne
