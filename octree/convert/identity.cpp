#include "octree/convert/identity.h"

#include <array>

#include <fmt/format.h>

#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/cluster/ranks.h"

namespace lucarne::octree {
namespace {

constexpr size_t kHeadBytes = 64 << 10;
constexpr int kRecords = 5;  ///< version of the stages' records (save and restore); raise it with any change

/// Empty for sources that are not files.
std::string file_identity(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    std::error_code error;
    const auto changed = std::filesystem::last_write_time(path, error);
    if (!file || error) return {};
    std::vector<std::byte> head(std::min<uint64_t>(file->size(), kHeadBytes));
    if (!file->read_at(0, head)) return {};
    return fmt::format(", {} bytes, changed {}, head {:016x}", file->size(),
                       changed.time_since_epoch().count(), format::checksum(head));
}

}  // namespace

std::string build_identity(const BuildOptions& options, InputRange own) {
    std::string text =
        fmt::format("format {}, records {}, --memory {}, --normals mode {}, --neighbours {}, search {} {}\n",
                    format::kVersion, kRecords, options.memory, static_cast<int>(options.normals),
                    options.neighbours, static_cast<int>(options.neighbour_search), options.read_options);
    if (options.ranks) text += fmt::format("rank {} of {}\n", options.ranks->rank(), options.ranks->count());
    for (size_t i = 0; i < options.inputs.size(); ++i) {
        const auto* input = options.inputs[i];
        SourceHeader header{.schema = input->schema()};
        header.scans.push_back(input->info());
        const std::string facts = metadata_text(header);
        std::error_code error;
        const auto path = std::filesystem::absolute(input->info().path, error);
        text += fmt::format("{}{}, header {:016x}\n", path.string(),
                            i >= own.first && i < own.end ? file_identity(path) : "",
                            format::checksum(std::as_bytes(std::span(facts))));
    }
    return text;
}

}  // namespace lucarne::octree
