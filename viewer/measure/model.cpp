#include "viewer/measure/model.h"

#include <span>
#include <utility>

#include <fmt/format.h>

#include "viewer/measure/file.h"

namespace lucarne::viewer {

void MeasureModel::start(MeasureKind kind) {
    tool = kind;
    pending.clear();
    message = prompt = fmt::format("{}: click {}", info_of(kind).title, info_of(kind).hint);
}

void MeasureModel::take(ExactPoint point) {
    if (!tool) return;
    pending.push_back(std::move(point));
    if (pending.size() < info_of(*tool).most) {
        const auto& [x, y, z] = pending.back().coordinates;
        message = prompt = fmt::format("{} {} {}", x, y, z);
    } else {
        finish();
    }
}

bool MeasureModel::finish() {
    if (!can_finish()) return false;
    Measurement done{*tool, "", std::exchange(pending, {}), *tool == MeasureKind::section ? thickness : 0};
    if (!list.add(std::move(done))) {
        message = "the list of measurements is full; save and delete some";
        return true;
    }
    selected = list.all().size() - 1;
    message = list.all().back().name;
    return true;
}

void MeasureModel::drop_last() {
    if (!pending.empty()) pending.pop_back();
}

void MeasureModel::stop() {
    if (message == prompt) message.clear();
    tool.reset();
    pending.clear();
}

void MeasureModel::remove_selected() {
    if (!selected_one()) return;
    message = "deleted " + selected_one()->name;
    list.remove(*selected);
    selected.reset();
}

void MeasureModel::copy_selected() {
    const Measurement* one = selected_one();
    const std::span<const Measurement> what = one ? std::span(one, 1) : std::span(list.all());
    if (what.empty()) return;
    commands.push(CopyText{measurements_text(what, units())});
    message = one ? "copied " + one->name : fmt::format("copied {} measurements", what.size());
}

Result<void> MeasureModel::save(const std::filesystem::path& path) {
    LUCARNE_TRY(save_measurements(path, list.all(), units(), path == own_file));
    own_file = path;
    list.mark_saved();
    return {};
}

Result<void> MeasureModel::load(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(auto loaded, load_measurements(path, metres_per_unit));
    own_file = path;
    list.replace(std::move(loaded));
    list.mark_saved();
    selected.reset();
    return {};
}

void MeasureModel::restore(std::vector<Measurement> kept, double its_metres_per_unit) {
    set_unit(its_metres_per_unit);
    list.restart(std::move(kept));
    selected.reset();
}

void MeasureModel::set_unit(double its_metres_per_unit) {
    if (its_metres_per_unit == metres_per_unit) return;
    const double factor = metres_per_unit / its_metres_per_unit;
    metres_per_unit = its_metres_per_unit;
    list.scale(factor);
    for (ExactPoint& point : pending) point.position *= factor;
    thickness *= factor;
}

const Measurement* MeasureModel::selected_one() const {
    return selected && *selected < list.all().size() ? &list.all()[*selected] : nullptr;
}

}  // namespace lucarne::viewer
