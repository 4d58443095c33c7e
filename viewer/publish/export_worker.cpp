#include "viewer/publish/export_worker.h"

#include <fmt/format.h>

#include "io/core/counted.h"
#include "viewer/publish/seen_points.h"

namespace lucarne::viewer {
namespace {

constexpr double kStep = 0.01;  ///< share of the work after which the window is told

}  // namespace

Result<std::string> ExportWorker::write(const ExportOrder& order) {
    const octree::SourceHeader& header = order.source->header();
    octree::ExportOptions options;
    options.spacing = order.spacing / header.metres_per_unit;
    options.every = order.every;
    options.cancelled = [this] { return work_.cancelled().load(); };
    export_what_is_seen(order.look, header.schema, options);
    const octree::Exporter exporter(*order.source, options);
    uint64_t done = 0;
    LUCARNE_ASSIGN(const uint64_t written,
                   write_points(exporter, order.file, order.overwrite, [&](uint64_t points) {
                       done += points;
                       const double share = static_cast<double>(done) / static_cast<double>(header.points);
                       work_.update([&](ExportState& shown) {
                           const bool tell = share - shown.share >= kStep;
                           if (tell) shown.share = share;
                           return tell;
                       });
                   }));
    return fmt::format("exported {} of {} to {}", written, counted(header.points, "points"),
                       order.file.string());
}

bool ExportWorker::start(ExportOrder order) {
    const std::string file = order.file.string();
    return work_.start(file, {true, 0, file}, [this, order = std::move(order)] { return write(order); });
}

}  // namespace lucarne::viewer
