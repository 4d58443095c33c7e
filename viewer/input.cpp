#include "viewer/input.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/scan.h"
#include "octree/build/build.h"
#include "octree/cache.h"

namespace lucarne::viewer {
namespace {

/// A folder of our own that is removed with all that is in it.
class TemporaryFolder {
 public:
    static Result<TemporaryFolder> create() {
        std::error_code code;
        const auto base = std::filesystem::temp_directory_path(code);
        if (code)
            return failed("temporary folder", code.message(), "set TMPDIR to a folder that can be written");
        std::string name = (base / "lucarne-XXXXXX").string();
        if (!mkdtemp(name.data()))
            return failed(base.string(), std::strerror(errno), "set TMPDIR to a folder that can be written");
        return TemporaryFolder(name);
    }
    TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::move(other.path_)) { other.path_.clear(); }
    TemporaryFolder& operator=(TemporaryFolder&&) = delete;
    ~TemporaryFolder() {
        std::error_code code;
        if (!path_.empty()) std::filesystem::remove_all(path_, code);
    }
    const std::filesystem::path& path() const { return path_; }

 private:
    explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
    std::filesystem::path path_;
};

}  // namespace

Result<std::shared_ptr<const octree::NodeSource>> open_input(const std::filesystem::path& path) {
    if (octree::is_cache(path)) {
        LUCARNE_ASSIGN(auto cache, octree::open_cache(path));
        return std::shared_ptr<const octree::NodeSource>(std::move(cache));
    }
    LUCARNE_ASSIGN(const auto scan, io::open_scan(path));
    log::info("{}: {}; converting it into a temporary cache (lucarne convert keeps one)", path.string(),
              scan->info().format);
    LUCARNE_ASSIGN(const TemporaryFolder folder, TemporaryFolder::create());
    octree::BuildOptions build;
    build.inputs = {scan.get()};
    build.output = folder.path() / "scan.luc";
    LUCARNE_TRY(octree::build_cache(build));
    // The open file lives on after its name is gone with the folder.
    LUCARNE_ASSIGN(auto cache, octree::open_cache(build.output));
    return std::shared_ptr<const octree::NodeSource>(std::move(cache));
}

}  // namespace lucarne::viewer
