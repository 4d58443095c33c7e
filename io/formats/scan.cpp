#include "io/formats/scan.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "io/core/counted.h"
#include "io/formats/common/color_depth.h"
#include "io/formats/e57/pages.h"
#include "io/formats/mesh/source.h"

namespace lucarne::io {

std::string options_text(const ReadOptions& options) {
    std::string text;
    if (!options.columns.empty()) text += fmt::format("--columns {}", options.columns);
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : " ") + more; };
    if (options.metres_per_unit) add(fmt::format("--unit {}", *options.metres_per_unit));
    if (options.up != UpAxis::z) add(fmt::format("--up {}", up_axis_name(options.up)));
    if (options.mesh.spacing > 0) add(fmt::format("--spacing {}", options.mesh.spacing));
    if (options.mesh.samples > 0) add(fmt::format("--mesh-points {}", options.mesh.samples));
    if (options.mesh.vertices) add("--vertices");
    if (options.salvage) add("--salvage");
    return text;
}

Result<Contents> survey(const PointSource& scan, const std::function<void(uint64_t)>& progress) {
    constexpr size_t kBatchPoints = size_t{1} << 16;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const Schema& schema = scan.schema();
    Contents contents{.min = glm::dvec3(kInfinity), .max = glm::dvec3(-kInfinity)};
    LUCARNE_ASSIGN(const auto reader, scan.open());
    ColorDepth depth(schema);
    PointBatch batch;
    for (;;) {
        LUCARNE_ASSIGN(const size_t count, reader->read(batch, kBatchPoints));
        if (count == 0) break;
        for (size_t i = 0; i < count; ++i) {
            const auto p = position_of(schema, &batch.bytes[i * schema.stride]);
            contents.min = glm::min(contents.min, p);
            contents.max = glm::max(contents.max, p);
        }
        contents.points += count;
        depth.add(std::span(batch.bytes).first(count * schema.stride));
        if (progress) progress(count);
    }
    contents.color_bits = depth.bits();
    contents.losses = scan.info().losses;
    add_losses(contents.losses, reader->losses());
    return contents;
}

namespace {

/// Returns what can be saved of a damaged scan that was opened with `salvage`. Returns nothing if the scan is
/// not damaged: it may have been rejected because of another file.
std::optional<std::string> savable(const PointSource& scan) {
    const ScanInfo& info = scan.info();
    const auto damaged = [](const Losses& losses) {
        constexpr std::array kDamage = {lost::cut_off,       lost::damaged,      lost::scan_header,
                                        e57::kWrongPages,    e57::kCutChecksums, mesh::kCutFaces,
                                        mesh::kDamagedFaces, mesh::kCutLine,     mesh::kDamagedLines};
        return std::ranges::any_of(
            losses, [&](const Loss& loss) { return std::ranges::find(kDamage, loss.what) != kDamage.end(); });
    };
    // Making the samples of a mesh only to count them would take too long.
    if (mesh::is_sampled(info)) {
        if (!damaged(info.losses)) return std::nullopt;
        return fmt::format("{}, about {}, can be saved with --salvage",
                           counted(info.notes.mesh->triangles, "whole triangles"),
                           counted(info.declared_points, "points"));
    }
    const auto contents = survey(scan);
    if (!contents || !damaged(contents->losses)) return std::nullopt;
    if (contents->points == 0) return "none of its points can be saved";
    return counted(contents->points, "points") + " can be saved with --salvage";
}

}  // namespace

Error with_salvage_advice(Error error, const std::filesystem::path& path, const ReadOptions& options) {
    if (error.kind != ErrorKind::input_rejected || options.salvage || error.what != path.string())
        return error;
    ReadOptions salvaging = options;
    salvaging.salvage = salvaging.quiet = true;
    const auto scan = open_scan(path, salvaging);
    if (!scan) return error;
    const auto found = savable(**scan);
    if (!found) return error;
    if (!error.todo.empty()) error.todo += ", or ";
    error.todo += *found;
    return error;
}

}  // namespace lucarne::io
