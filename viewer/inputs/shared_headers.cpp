#include "viewer/inputs/shared_headers.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/core/log_silence.h"
#include "octree/cache/metadata.h"
#include "octree/convert/chunks/record_bytes.h"
#include "octree/convert/together.h"

namespace lucarne::viewer {
namespace {

using Bytes = octree::Ranks::Bytes;
using octree::ByteReader;
using octree::ByteWriter;

enum class Told : uint8_t { header, error, read_it };

Result<ScanHeader> read_header(const std::string& path, const io::ReadOptions& options) {
    LUCARNE_ASSIGN(const auto scan, io::open_scan(path, options));
    return ScanHeader{scan->schema(), scan->info()};
}

Bytes bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}
std::string text_of(const Bytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Writes the header as the metadata of a cache without points, and beside it what caches do not keep.
Bytes written(const ScanHeader& header) {
    ByteWriter writer;
    writer.put(header.info.unit_stated);
    writer.put(header.info.stated_box.has_value());
    if (header.info.stated_box) writer.put(*header.info.stated_box);
    writer.put_all(bytes_of(header.info.path));  // not always UTF-8
    octree::SourceHeader cache{.schema = header.schema, .root = {glm::dvec3(0), 1}};
    cache.scans.push_back(header.info);
    writer.put_all(bytes_of(metadata_text(cache)));
    return writer.take();
}

/// What this rank tells of its share of the files.
Bytes tell(const std::vector<std::string>& paths, const io::ReadOptions& options,
           const octree::Ranks& ranks) {
    const log::Speaking speaking(ranks.rank() > 0);
    ByteWriter writer;
    const size_t first = paths.size() * ranks.rank() / ranks.count(),
                 end = paths.size() * (ranks.rank() + 1) / ranks.count();
    for (size_t i = first; i < end; ++i) {
        const auto header = read_header(paths[i], options);
        const Bytes bytes = header ? encode_header(*header) : octree::encode_error(header.error());
        writer.put(!header ? Told::error : bytes.empty() ? Told::read_it : Told::header);
        writer.put_all(bytes);
    }
    return writer.take();
}

}  // namespace

Bytes encode_header(const ScanHeader& header) {
    Bytes bytes = written(header);
    const auto read = decode_header(bytes);
    const bool same = read && read->schema == header.schema && written(*read) == bytes;
    return same ? bytes : Bytes();
}

Result<ScanHeader> decode_header(std::span<const std::byte> bytes) {
    ByteReader reader(bytes);
    const bool unit_stated = reader.get<uint8_t>() != 0, boxed = reader.get<uint8_t>() != 0;
    std::optional<std::array<glm::dvec3, 2>> box;
    if (boxed) box = reader.get<std::array<glm::dvec3, 2>>();
    const std::string path = text_of(reader.get_all<std::byte>());
    const std::string text = text_of(reader.get_all<std::byte>());
    if (!reader.sound()) return failed("a header", "has come incomplete from another rank");
    LUCARNE_ASSIGN(auto cache, octree::parse_metadata(path, text));
    if (cache.scans.size() != 1) return failed("a header", "has come damaged from another rank");
    ScanHeader header{std::move(cache.schema), std::move(cache.scans[0])};
    header.info.path = path;
    header.info.unit_stated = unit_stated;
    header.info.stated_box = box;
    return header;
}

std::vector<Result<ScanHeader>> read_headers(const std::vector<std::string>& paths,
                                             const io::ReadOptions& options) {
    std::vector<Result<ScanHeader>> headers;
    for (const std::string& path : paths) headers.push_back(read_header(path, options));
    return headers;
}

Result<std::vector<Result<ScanHeader>>> read_headers_together(const std::vector<std::string>& paths,
                                                              const io::ReadOptions& options,
                                                              octree::Ranks& ranks) {
    LUCARNE_TRY(octree::check_program(ranks));
    LUCARNE_TRY(octree::check_same(ranks, "list of inputs", fmt::format("{}", fmt::join(paths, "\n"))));
    std::vector<Result<ScanHeader>> headers;
    LUCARNE_ASSIGN(const auto all, octree::share(ranks, tell(paths, options, ranks)));
    for (const Bytes& part : all)
        for (ByteReader reader(part); reader.left() > 0 && headers.size() < paths.size();) {
            const auto told = reader.get<Told>();
            const Bytes bytes = reader.get_all<std::byte>();
            if (told == Told::header)
                headers.push_back(decode_header(bytes));
            else if (told == Told::error)
                headers.push_back(tl::make_unexpected(octree::decode_error(bytes)));
            else {
                const log::Hush said_by_its_rank;
                headers.push_back(read_header(paths[headers.size()], options));
            }
        }
    if (headers.size() != paths.size()) return failed("headers", "have come incomplete from another rank");
    return headers;
}

}  // namespace lucarne::viewer
