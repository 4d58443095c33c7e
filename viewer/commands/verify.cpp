#include <filesystem>
#include <memory>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/progress.h"
#include "io/files/file.h"
#include "octree/cache/cache.h"
#include "viewer/commands/commands.h"

namespace lucarne::viewer {
namespace {

Result<void> verify(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const std::shared_ptr<const ByteSource> file, InputFile::open_shared(path));
    uint64_t bytes = 0;
    {
        LUCARNE_ASSIGN(const auto cache, octree::open_cache(file));
        for (const auto& node : cache->nodes()) bytes += node.payload_bytes;
    }
    Progress progress("verifying", bytes, "bytes");
    LUCARNE_ASSIGN(const auto report, octree::verify_cache(file, [&](uint64_t done) { progress.add(done); }));
    log::info("{}: sound; {} points in {} nodes on {} levels, {}", path.string(), report.points, report.nodes,
              report.depth + 1, bytes_text(report.bytes));
    if (report.bytes_behind_end)
        log::warn(
            "{}: has {} of an interrupted update behind its end, which do no harm; lucarne compact removes "
            "them",
            path.string(), counted(report.bytes_behind_end, "bytes"));
    return {};
}

}  // namespace

void add_verify(CommandLine& line) {
    auto path = std::make_shared<std::filesystem::path>();
    Arguments command = line.add("verify", "Check every checksum and invariant of a cache");
    command.add("cache", *path, "The cache to read").required().type_name("CACHE");
    command.run([path] { return verify(*path); });
}

}  // namespace lucarne::viewer
