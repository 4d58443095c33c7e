#include "viewer/measure/list.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace lucarne::viewer {

bool MeasureList::add(Measurement measurement) {
    if (all().size() >= kMost) return false;
    for (size_t number = 1; measurement.name.empty(); ++number) {
        std::string name = fmt::format("{} {}", info_of(measurement.kind).title, number);
        if (std::ranges::find(all(), name, &Measurement::name) == all().end())
            measurement.name = std::move(name);
    }
    std::vector<Measurement> next = all();
    next.push_back(std::move(measurement));
    replace(std::move(next));
    return true;
}

void MeasureList::remove(size_t index) {
    if (index >= all().size()) return;
    std::vector<Measurement> next = all();
    next.erase(next.begin() + static_cast<ptrdiff_t>(index));
    replace(std::move(next));
}

void MeasureList::rename(size_t index, std::string name) {
    if (index >= all().size() || name.empty() || all()[index].name == name) return;
    std::vector<Measurement> next = all();
    next[index].name = std::move(name);
    replace(std::move(next));
}

void MeasureList::set_thickness(size_t index, double thickness) {
    if (index >= all().size() || all()[index].thickness == thickness) return;
    std::vector<Measurement> next = all();
    next[index].thickness = thickness;
    replace(std::move(next));
}

void MeasureList::replace(std::vector<Measurement> all) {
    now_ = std::make_shared<const std::vector<Measurement>>(std::move(all));
}

void MeasureList::restart(std::vector<Measurement> all) {
    replace(std::move(all));
    saved_ = now_;
}

void MeasureList::scale(double factor) {
    std::vector<Measurement> next = all();
    for (Measurement& measurement : next) {
        for (ExactPoint& point : measurement.points) point.position *= factor;
        measurement.thickness *= factor;
    }
    const bool saved = now_ == saved_;
    replace(std::move(next));
    if (saved) saved_ = now_;
}

}  // namespace lucarne::viewer
