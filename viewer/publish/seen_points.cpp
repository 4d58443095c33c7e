#include "viewer/publish/seen_points.h"

#include "io/formats/copc/copc.h"
#include "io/formats/scan.h"

namespace lucarne::viewer {

void export_what_is_seen(const gi::Look& look, const io::Schema& schema, octree::ExportOptions& options) {
    const gi::Clip& clip = look.clip;
    if (clip.active())
        options.meets = [clip](const octree::Cube& cube) { return gi::kept(clip, cube) != gi::Kept::none; };
    const io::Attribute* const found = schema.find(io::names::classification);
    const bool by_class = found && look.hidden_classes.any();
    if (!clip.active() && !by_class) return;
    const io::Attribute classes = by_class ? *found : io::Attribute{};
    options.keeps = [clip, by_class, classes, hidden = look.hidden_classes](const glm::dvec3& point,
                                                                            const std::byte* record) {
        if (by_class) {
            const double number = io::scalar_at(classes.type, record + classes.offset);
            if (number >= 0 && number < 256 && hidden[static_cast<size_t>(number)]) return false;
        }
        return gi::keeps(clip, point);
    };
}

Result<uint64_t> write_points(const octree::Exporter& exporter, const std::filesystem::path& file,
                              bool overwrite, const std::function<void(uint64_t)>& progress) {
    if (io::copc::is_name(file)) return exporter.write_copc(file, overwrite, progress);
    LUCARNE_ASSIGN(const auto writer, io::create_scan(file, exporter.schema(), exporter.info(),
                                                      exporter.write_options(overwrite)));
    return exporter.write(*writer, progress);
}

}  // namespace lucarne::viewer
