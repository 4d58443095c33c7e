#include "gi/engines/paths/store.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <glm/vec4.hpp>

namespace lucarne::gi::paths {
namespace {

template <class T>
void put(BakeSections& sections, std::string_view name, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(std::span(values));
    sections[std::string(name)].assign(bytes.begin(), bytes.end());
}

tl::unexpected<Error> damaged(std::string_view name) {
    return rejected("paths", "the section " + std::string(name) + " is damaged");
}

template <class T>
Result<void> take(const BakeSections& sections, std::string_view name, std::vector<T>& values) {
    const auto found = sections.find(std::string(name));
    if (found == sections.end() || found->second.size() % sizeof(T) != 0) return damaged(name);
    values.resize(found->second.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), found->second.data(), found->second.size());
    return {};
}

bool all_below(const std::vector<uint32_t>& values, size_t end, bool or_none) {
    return std::ranges::all_of(values, [&](uint32_t v) { return v < end || (or_none && v == kNone); });
}

/// Whether these are the starts of `count` consecutive ranges that end at `end`.
bool are_ranges(const std::vector<uint32_t>& starts, size_t count, size_t end) {
    return starts.size() == count + 1 && starts.front() == 0 && starts.back() == end &&
           std::ranges::is_sorted(starts);
}

bool is_sound(const Groups& groups) {
    const size_t count = groups.parent.size(), larger = count - groups.leaves;
    if (groups.leaves > count || groups.area.size() != count || groups.cell.size() != count) return false;
    if (!all_below(groups.parent, count, true) || !are_ranges(groups.first, larger, groups.children.size()))
        return false;
    for (const float area : groups.area)
        if (!(area >= 0) || !std::isfinite(area)) return false;
    for (const float cell : groups.cell)
        if (!(cell >= 0) || !std::isfinite(cell)) return false;
    if (!std::ranges::is_sorted(groups.level_ends)) return false;
    uint32_t begin = groups.leaves;
    for (const uint32_t end : groups.level_ends) {
        if (end < begin || end > count) return false;
        // Children belong to smaller cells, which are summed first.
        for (uint32_t i = groups.first[begin - groups.leaves]; i < groups.first[end - groups.leaves]; ++i)
            if (groups.children[i] >= begin) return false;
        begin = end;
    }
    return begin == count;
}

}  // namespace

BakeSections write_paths(const LightPaths& paths) {
    BakeSections sections;
    const Groups& groups = paths.groups;
    put(sections, "points", paths.points);
    put(sections, "rays", paths.rays);
    put(sections, "links", paths.links.groups);
    put(sections, "first links", paths.links.first);
    put(sections, "links of leaves", paths.links.origin_of);
    put(sections, "open links", paths.links.open);
    put(sections, "first open links", paths.links.first_open);
    put(sections, "hidden points", paths.hidden);
    put(sections, "photons", paths.photons);
    put(sections, "entries", paths.entries.sides);
    put(sections, "entries of leaves", paths.entries.first);
    put(sections, "places of entries", paths.entries.places);
    put(sections, "parents", groups.parent);
    put(sections, "areas", groups.area);
    put(sections, "cells", groups.cell);
    put(sections, "children", groups.children);
    put(sections, "first children", groups.first);
    put(sections, "levels", groups.level_ends);
    put(sections, "planes", groups.planes);
    put(sections, "cube", std::vector{glm::vec4(groups.corner, groups.edge)});
    return sections;
}

Result<LightPaths> read_paths(const BakeSections& sections, uint32_t rays_a_point) {
    LightPaths paths{.rays_a_point = rays_a_point};
    Groups& groups = paths.groups;
    LUCARNE_TRY(take(sections, "points", paths.points));
    LUCARNE_TRY(take(sections, "rays", paths.rays));
    LUCARNE_TRY(take(sections, "links", paths.links.groups));
    LUCARNE_TRY(take(sections, "first links", paths.links.first));
    LUCARNE_TRY(take(sections, "links of leaves", paths.links.origin_of));
    LUCARNE_TRY(take(sections, "open links", paths.links.open));
    LUCARNE_TRY(take(sections, "first open links", paths.links.first_open));
    LUCARNE_TRY(take(sections, "hidden points", paths.hidden));
    LUCARNE_TRY(take(sections, "photons", paths.photons));
    LUCARNE_TRY(take(sections, "entries", paths.entries.sides));
    LUCARNE_TRY(take(sections, "entries of leaves", paths.entries.first));
    LUCARNE_TRY(take(sections, "places of entries", paths.entries.places));
    LUCARNE_TRY(take(sections, "parents", groups.parent));
    LUCARNE_TRY(take(sections, "areas", groups.area));
    LUCARNE_TRY(take(sections, "cells", groups.cell));
    LUCARNE_TRY(take(sections, "children", groups.children));
    LUCARNE_TRY(take(sections, "first children", groups.first));
    LUCARNE_TRY(take(sections, "levels", groups.level_ends));
    LUCARNE_TRY(take(sections, "planes", groups.planes));
    std::vector<glm::vec4> cube;
    LUCARNE_TRY(take(sections, "cube", cube));
    // Farther away, distances would be beyond floats.
    const auto is_place = [](float at) { return std::abs(at) < 1e7f; };
    if (cube.size() != 1 || !is_place(cube[0].x) || !is_place(cube[0].y) || !is_place(cube[0].z) ||
        !(cube[0].w > 0) || !is_place(cube[0].w))
        return damaged("cube");
    groups.corner = glm::vec3(cube[0]);
    groups.edge = cube[0].w;
    if (groups.first.empty() || groups.first.size() - 1 > groups.parent.size())
        return damaged("first children");
    groups.leaves = static_cast<uint32_t>(groups.parent.size() - (groups.first.size() - 1));
    if (groups.planes.size() != groups.leaves) return damaged("planes");
    if (!is_sound(groups)) return damaged("children");
    const auto is_point = [](const GatheringPoint& p) { return p.reach > 0 && p.is_finite(); };
    if (!std::ranges::all_of(paths.points, is_point)) return damaged("points");
    if (!std::ranges::all_of(paths.hidden,
                             [&](const PointPair& pair) {
                                 return pair.first < paths.points.size() &&
                                        pair.second < paths.points.size() && pair.first != pair.second;
                             }) ||
        !std::ranges::is_sorted(paths.hidden, {}, &PointPair::first))
        return damaged("hidden points");
    if (paths.rays.size() != paths.points.size() * rays_a_point ||
        !all_below(paths.rays, groups.count(), true))
        return damaged("rays");
    const Links& links = paths.links;
    if (links.first.empty() || !are_ranges(links.first, links.origins(), links.groups.size()) ||
        !are_ranges(links.first_open, links.origins(), links.open.size()) ||
        !all_below(links.groups, groups.count(), false) || links.origin_of.size() != groups.leaves ||
        !all_below(links.origin_of, links.origins(), true))
        return damaged("links");
    if (!are_ranges(paths.entries.first, groups.leaves, paths.entries.sides.size()) ||
        paths.entries.places.size() != paths.entries.sides.size())
        return damaged("entries");
    if (paths.photons.size() != paths.entries.sides.size() * (kVertices - 1) ||
        !all_below(paths.photons, groups.leaves, true))
        return damaged("photons");
    return paths;
}

BakeSections write_points(const PointChooser::State& state) {
    BakeSections sections;
    put(sections, "points", state.points);
    put(sections, "hits", state.hits);
    put(sections, "parts", std::vector{state.parts});
    put(sections, "next", std::vector{state.next});
    put(sections, "spacing", std::vector{state.spacing});
    return sections;
}

Result<PointChooser::State> read_points(const BakeSections& sections) {
    PointChooser::State state;
    std::vector<uint64_t> next, parts;
    std::vector<Spacing> spacing;
    LUCARNE_TRY(take(sections, "points", state.points));
    LUCARNE_TRY(take(sections, "hits", state.hits));
    LUCARNE_TRY(take(sections, "parts", parts));
    LUCARNE_TRY(take(sections, "next", next));
    LUCARNE_TRY(take(sections, "spacing", spacing));
    if (next.size() != 1 || spacing.size() != 1 || parts.size() != 1) return damaged("next");
    state.parts = parts[0];
    state.next = next[0];
    state.spacing = spacing[0];
    return state;
}

}  // namespace lucarne::gi::paths
