#include "octree/convert/identity.h"

#include <algorithm>

#include <fmt/format.h>

#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/cluster/ranks.h"

namespace lucarne::octree {
namespace {

constexpr size_t kHeadBytes = 64 << 10;
/// Version of the stages' records (save and restore). Raise it with any change, also of what is estimated: a
/// conversion that goes on must not mix borders of two kinds.
constexpr int kRecords = 10;

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

Result<std::string> build_identity(const BuildOptions& options, InputRange own, Ranks& ranks) {
    Ranks::Bytes found;
    for (size_t i = own.first; i < own.end; ++i) {
        if (own.begin_in(i) > 0) continue;  // the rank with its first part says it
        std::error_code error;
        const std::string file =
            file_identity(std::filesystem::absolute(options.inputs[i]->info().path, error)) + "\n";
        const auto bytes = std::as_bytes(std::span(file));
        found.insert(found.end(), bytes.begin(), bytes.end());
    }
    LUCARNE_ASSIGN(const auto all, share(ranks, found));
    std::string files;  // a line for each input
    for (const Ranks::Bytes& part : all)
        files.append(reinterpret_cast<const char*>(part.data()), part.size());
    std::string text =
        fmt::format("format {}, records {}, --memory {}, --normals mode {}, --neighbours {}, search {} {}\n",
                    format::kVersion, kRecords, options.memory, static_cast<int>(options.normals),
                    options.neighbours, static_cast<int>(options.neighbour_search), options.read_options);
    for (size_t i = 0, line = 0; i < options.inputs.size(); ++i) {
        const auto* input = options.inputs[i];
        SourceHeader header{.schema = input->schema()};
        header.scans.push_back(input->info());
        const std::string facts = metadata_text(header);
        std::error_code error;
        const auto path = std::filesystem::absolute(input->info().path, error);
        const size_t end = std::min(files.find('\n', line), files.size());
        text += fmt::format("{}{}, header {:016x}\n", path.string(), files.substr(line, end - line),
                            format::checksum(std::as_bytes(std::span(facts))));
        line = std::min(end + 1, files.size());
    }
    return text;
}

}  // namespace lucarne::octree
