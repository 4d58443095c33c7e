#include "viewer/window/unsaved.h"

#include <system_error>
#include <utility>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/files/free_name.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {
namespace {

/// Returns `file`, or a free name if a file other than `own` has that name. With SaveTo::free_names returns a
/// name in View::pictures, because the folder of an opened file may belong to somebody else.
std::filesystem::path place(const ViewModel& model, const std::filesystem::path& file,
                            const std::filesystem::path& own, SaveTo to) {
    if (to == SaveTo::own_files && file == own) return file;
    const auto wanted = to == SaveTo::own_files ? file : model.view.pictures / file.filename();
    std::error_code ignored;
    if (!std::filesystem::exists(wanted, ignored)) return wanted;
    const std::string extension = wanted.extension().string();
    return free_name(wanted.parent_path(), wanted.stem().string(), {extension}).string() + extension;
}

std::string measurements_text(const MeasureModel& measure) {
    return counted(measure.list.all().size() + (measure.can_finish() ? 1 : 0), "measurements");
}

}  // namespace

std::vector<Unsaved> unsaved(const ViewModel& model, SaveTo to) {
    std::vector<Unsaved> all;
    if (const MeasureModel& measure = model.measure; measure.unsaved()) {
        const auto file = place(model, model.view.pictures / measure.file, measure.own_file, to);
        all.push_back({measurements_text(measure), file, [file](ViewModel& of) {
                           of.measure.finish();
                           return of.measure.save(file);
                       }});
    }
    if (const PublishModel& show = model.publish; show.editor.unsaved()) {
        const auto file = place(model, model.view.pictures / show.path_file, show.own_path, to);
        const size_t keys = show.editor.path().keys.size();
        all.push_back({"a flythrough of " + counted(keys, "key frames"), file,
                       [file](ViewModel& of) { return of.publish.save_path(file); }});
    }
    if (const SceneFile& scene = model.scene_file; scene.differs(model.view)) {
        const auto file = place(model, scene.place(model.view), scene.path(), to);
        all.push_back({"the scene: lights, look or clips were changed", file,
                       [file](ViewModel& of) { return of.scene_file.save_as(of.view, file); }});
    }
    return all;
}

std::vector<Unsaved> work_to_lose(const ViewModel& model) {
    return model.closing.kept ? std::vector<Unsaved>() : unsaved(model);
}

Result<void> save_unsaved(ViewModel& model, SaveTo to) {
    Result<void> first;
    for (const Unsaved& one : unsaved(model, to)) {
        auto saved = one.save(model);
        if (saved) log::info("saved {}", whole_path(one.file));
        if (!saved && first) first = std::move(saved);
    }
    return first;
}

}  // namespace lucarne::viewer
