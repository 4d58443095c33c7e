// How well a picture of a scan keeps the outlines of the true surface: where surfaces end before what is
// behind them, and where two faces meet.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/shared/surfel.h"
#include "tests/bench/true_surface.h"

namespace lucarne::bench {

/// The length of outlines, in pixels, and that of those which lie where they should.
struct OutlineLength {
    double all = 0, kept = 0;
};
struct Outlines {
    OutlineLength creases;  ///< kept: within kCreaseShift spacings
    OutlineLength steps;    ///< of depth; kept: within kStepShift spacings
};
inline constexpr double kCreaseShift = .25, kStepShift = .5;

/// Compares the outlines of a picture with the true ones. Rows and columns of pixels are searched for true
/// outlines across them. About each, as far as two spacings to both sides, as many pixels must show the
/// nearer surface (or the first face) as in truth; the difference is how far the outline is shifted. Outlines
/// that are nearer to another one, of which the scan lacks a side, or of which the shift allowed is not two
/// pixels, are left out.
class OutlineJudge {
 public:
    using Pixel = TrueView::Pixel;
    /// `shown`: what the scan shows, as `lucarne render --gbuffer` writes it. `spacing`: returns that of the
    /// scan's points at a pixel of the true surface, in pixels; 0: not known. `scanned`: returns whether the
    /// scan has a point of the true surface at a pixel, or within so many pixels of it.
    /// `pixel_size`: of a pixel at a depth of one metre, m.
    OutlineJudge(const std::vector<Pixel>& truth, const std::vector<glm::vec4>& shown, uint32_t width,
                 double pixel_size, std::function<double(size_t)> spacing,
                 std::function<bool(size_t, double)> scanned)
        : truth_(truth),
          shown_(shown),
          width_(width),
          pixel_size_(pixel_size),
          spacing_(std::move(spacing)),
          scanned_(std::move(scanned)) {}

    Outlines judge() const {
        Outlines found;
        const size_t height = truth_.size() / width_;
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x + 1 < width_; ++x) look({x, y, 1, width_, width_, height}, found);
        for (size_t x = 0; x < width_; ++x)
            for (size_t y = 0; y + 1 < height; ++y) look({y, x, width_, 1, height, width_}, found);
        return found;
    }

 private:
    static constexpr double kBend = 30;                           ///< degrees between the faces at a crease
    static constexpr double kStep = 4;                            ///< spacings between the surfaces at a step
    static constexpr double kLeastStep = .05;                     ///< m
    static constexpr double kAround = 2;                          ///< spacings
    static constexpr double kScanned = 1.5;                       ///< spacings: a point is as near
    static constexpr double kLeastShift = 2;                      ///< pixels: shifts are whole pixels
    static constexpr size_t kLeastAround = 3, kMostAround = 256;  ///< pixels

    enum class Kind { none, crease, step };

    /// A pair of neighbours: `at` and at + 1 of a line.
    struct Pair {
        size_t at, line;        ///< place along the line, and which line
        size_t stride, across;  ///< of pixels: along the line, and to the next line
        size_t length, lines;
        size_t pixel(size_t place) const { return place * stride + line * across; }
    };

    bool is_step(const Pixel& a, const Pixel& b, double spacing_m) const {
        if (!(a.depth > 0) || !(b.depth > 0)) return (a.depth > 0) != (b.depth > 0);
        return std::abs(a.depth - b.depth) > std::max(kLeastStep, kStep * spacing_m);
    }
    Kind kind(size_t first, size_t second, double spacing_m) const {
        const Pixel &a = truth_[first], &b = truth_[second];
        if (is_step(a, b, spacing_m)) return Kind::step;
        return a.depth > 0 && plane_angle(a.normal, b.normal) > kBend ? Kind::crease : Kind::none;
    }

    void look(const Pair& pair, Outlines& found) const {
        const size_t first = pair.pixel(pair.at), second = pair.pixel(pair.at + 1);
        const Pixel &a = truth_[first], &b = truth_[second];
        // Cheap: most neighbours are alike.
        const bool alike = a.depth > 0 && b.depth > 0 && std::abs(a.depth - b.depth) < kLeastStep &&
                           plane_angle(a.normal, b.normal) <= kBend;
        if (alike || (!(a.depth > 0) && !(b.depth > 0))) return;
        const bool first_is_near = a.depth > 0 && (!(b.depth > 0) || a.depth <= b.depth);
        const size_t near = first_is_near ? first : second;
        const double spacing = spacing_(near);  // pixels
        if (!(spacing > 0)) return;
        const double spacing_m = spacing * pixel_size_ * truth_[near].depth;
        const Kind what = kind(first, second, spacing_m);
        if (what == Kind::none) return;
        const double allowed = what == Kind::crease ? kCreaseShift : kStepShift;
        if (allowed * spacing < kLeastShift) return;
        // The outline crosses the lines beside this one nearby, so that it lies across this line.
        const auto slope = slope_at(pair, what, spacing_m);
        if (!slope || std::abs(*slope) > 1) return;
        const auto around = static_cast<size_t>(
            std::clamp(std::ceil(kAround * spacing), double{kLeastAround}, double{kMostAround}));
        if (pair.at < around || pair.at + 1 + around >= pair.length) return;
        long shift = 0;
        std::array<size_t, 2>
            present{};  // pixels to both sides that show the true surface or something before it
        for (size_t k = 0; k <= around; ++k)
            for (const bool upper : {false, true}) {
                const size_t pixel = pair.pixel(upper ? pair.at + 1 + k : pair.at - k);
                const Pixel& truth = truth_[pixel];
                const bool is_first = what == Kind::step ? upper != first_is_near : !upper;
                if (shows_first({truth.depth, truth.normal}, a, b, what) != is_first)
                    return;  // another is near
                const size_t before = pair.pixel(upper ? pair.at + 1 + k - (k > 0) : pair.at - k + (k > 0));
                if (what == Kind::crease && is_step(truth, truth_[before], spacing_m)) return;
                if (what == Kind::crease && k == around && !scanned_(pixel, kScanned * spacing)) return;
                const glm::vec4& shown = shown_[pixel];
                const bool nothing = !(truth.depth > 0);
                const bool farther =
                    shown.w > truth.depth && is_step(truth, {shown.w, truth.normal}, spacing_m);
                present[upper] += nothing || (shown.w > 0 && !farther);
                shift += static_cast<long>(shows_first({shown.w, glm::dvec3(shown)}, a, b, what)) -
                         static_cast<long>(is_first);
            }
        if (2 * std::min(present[0], present[1]) <= around) return;  // the scanner did not see one of them
        OutlineLength& length = what == Kind::crease ? found.creases : found.steps;
        const double stretched = std::sqrt(1 + *slope * *slope);
        length.all += stretched;
        if (std::abs(static_cast<double>(shift)) / stretched <= allowed * spacing) length.kept += stretched;
    }

    /// What a pixel shows: its depth (0: nothing) and a normal.
    struct Surface {
        double depth;
        glm::dvec3 normal;
    };
    /// Whether a pixel shows the nearer of the surfaces at a step, or the first of the faces at a crease.
    static bool shows_first(const Surface& pixel, const Pixel& a, const Pixel& b, Kind what) {
        if (what == Kind::crease)
            return std::abs(dot(pixel.normal, a.normal)) > std::abs(dot(pixel.normal, b.normal));
        if (!(pixel.depth > 0)) return false;
        return !(a.depth > 0) || !(b.depth > 0) || pixel.depth < std::sqrt(a.depth * b.depth);
    }

    /// Returns how many pixels the outline moves along the line from one line to the next.
    std::optional<double> slope_at(const Pair& pair, Kind what, double spacing_m) const {
        if (pair.line == 0 || pair.line + 1 >= pair.lines) return std::nullopt;
        std::array<int, 2> moved{};
        for (int side = 0; side < 2; ++side) {
            std::optional<int> nearest;
            for (const int k : {0, -1, 1, -2, 2}) {
                const long at = static_cast<long>(pair.at) + k;
                if (at < 0 || at + 1 >= static_cast<long>(pair.length)) continue;
                Pair other = pair;
                other.line = side == 0 ? pair.line - 1 : pair.line + 1;
                if (kind(other.pixel(static_cast<size_t>(at)), other.pixel(static_cast<size_t>(at) + 1),
                         spacing_m) != what)
                    continue;
                nearest = k;
                break;
            }
            if (!nearest) return std::nullopt;
            moved[static_cast<size_t>(side)] = *nearest;
        }
        return (moved[1] - moved[0]) / 2.0;
    }

    const std::vector<Pixel>& truth_;
    const std::vector<glm::vec4>& shown_;
    size_t width_;
    double pixel_size_;
    std::function<double(size_t)> spacing_;
    std::function<bool(size_t, double)> scanned_;
};

/// The spacing of a scan's points at places on its surface: the root of the nearest point's share.
class SpacingMap {
 public:
    explicit SpacingMap(const std::vector<gi::Surfel>& surfels) : surfels_(surfels) {
        for (size_t i = 0; i < surfels.size(); ++i)
            if (surfels[i].radius > 0)
                cells_[key(cell(surfels[i].position))].push_back(static_cast<uint32_t>(i));
    }
    /// Returns 0 where no point is near.
    double at(const glm::dvec3& place) const {
        double nearest = kCell * kCell, spacing = 0;
        visit(place, [&](const gi::Surfel& surfel, double squared) {
            if (squared < nearest) nearest = squared, spacing = std::sqrt(surfel.area);
        });
        return spacing;
    }
    /// Whether a point lies within `reach` (m, .1 at most) of a place, in a surface with about this normal.
    bool has_point(const glm::dvec3& place, const glm::dvec3& normal, double reach) const {
        reach = std::min(reach, kCell);
        bool found = false;
        visit(place, [&](const gi::Surfel& surfel, double squared) {
            found |= squared < reach * reach && plane_angle(glm::dvec3(surfel.normal), normal) < kSamePlane;
        });
        return found;
    }

 private:
    static constexpr double kCell = .1;       ///< m
    static constexpr double kSamePlane = 30;  ///< degrees
    /// Calls `see` with each surfel in the cells around a place and its squared distance, m^2.
    template <typename See>
    void visit(const glm::dvec3& place, const See& see) const {
        const glm::ivec3 middle = cell(glm::vec3(place));
        for (int i = 0; i < 27; ++i) {
            const auto found = cells_.find(key(middle + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1));
            if (found == cells_.end()) continue;
            for (const uint32_t number : found->second) {
                const glm::dvec3 away = glm::dvec3(surfels_[number].position) - place;
                see(surfels_[number], dot(away, away));
            }
        }
    }
    static glm::ivec3 cell(const glm::vec3& place) { return glm::ivec3(glm::floor(place / float{kCell})); }
    static uint64_t key(const glm::ivec3& cell) {
        uint64_t joined = 0;
        for (int axis = 0; axis < 3; ++axis)
            joined = joined << 21 | (static_cast<uint32_t>(cell[axis]) & 0x1fffff);
        return joined;
    }
    const std::vector<gi::Surfel>& surfels_;
    std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

}  // namespace lucarne::bench
