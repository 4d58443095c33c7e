#include <memory>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/options.h"
#include "octree/edit/edit.h"
#include "viewer/commands/commands.h"

namespace lucarne::viewer {

void add_compact(CommandLine& line) {
    struct Options {
        std::filesystem::path cache, temp_folder;
    };
    auto options = std::make_shared<Options>();
    Arguments command = line.add("compact", "Free the space of deleted or replaced points in a cache");
    command.add("cache", options->cache, "The cache to rewrite").required().type_name("CACHE");
    command.add("--temp", options->temp_folder, "Folder for temporary files (default: the cache's)")
        .type_name("DIR");
    const auto compact = [](const Options& given) -> Result<void> {
        LUCARNE_ASSIGN(const auto report, octree::compact_cache(given.cache, given.temp_folder));
        log::info("{}: {} before, {} now", given.cache.string(), bytes_text(report.bytes_before),
                  bytes_text(report.bytes));
        return {};
    };
    command.run([options, compact] { return compact(*options); });
}

}  // namespace lucarne::viewer
