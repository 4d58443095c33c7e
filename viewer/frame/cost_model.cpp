#include "viewer/frame/cost_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lucarne::viewer {
namespace {

constexpr size_t kRemembered = 24;       ///< frames that are remembered; changes are learned in half as many
constexpr double kLeastSpread = .1;      ///< relative difference of a cut's points needed for a slope
constexpr double kLeastView = 1.0 / 16;  ///< least share of the largest view's points
constexpr double kFall = 0.4, kRise = 1.25;  ///< limits of the view's change from frame to frame
constexpr double kCalm = 0.04;        ///< smaller changes are ignored: unchanged cuts are not sent again
constexpr double kWholeEnough = 0.8;  ///< least complete share of the cuts of a representative frame
constexpr int kPatience = 8;          ///< consecutive frames needed before the lights' budgets change
constexpr int kMostHalvings = 4;
constexpr double kSpare = 0.6;  ///< share of the target below which the lights' budgets may grow

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

double CostModel::Line::at(const CutPoints& points) const {
    double seconds = fixed;
    for (size_t cut = 0; cut < points.size(); ++cut) seconds += per_point[cut] * points[cut];
    return seconds;
}

void CostModel::forget() {
    passes_.clear();
    frames_ = 0;
}

void CostModel::observe(const FrameStats& frame) {
    const CutPoints points{static_cast<double>(frame.view_points),
                           static_cast<double>(frame.light_view_points),
                           static_cast<double>(frame.light_points)};
    std::map<std::string, double, std::less<>> seconds;
    double rest = frame.seconds;
    for (const auto& pass : frame.passes) {
        seconds[pass.name] += pass.seconds;
        rest -= pass.seconds;
    }
    seconds["rest"] = std::max(rest, 0.0);
    for (const auto& [name, samples] : passes_)
        seconds.try_emplace(name, 0.0);  // a missing pass costs nothing
    for (const auto& [name, value] : seconds) {
        auto& samples = passes_[name];
        samples.push_back({points, value});
        if (samples.size() > kRemembered) samples.pop_front();
    }
    ++frames_;
}

CostModel::Line CostModel::of_pass(const std::deque<Sample>& samples) {
    Line best;
    double least = std::numeric_limits<double>::infinity();
    bool any_spread = false;
    for (size_t cut = 0; cut < best.per_point.size(); ++cut) {
        std::vector<double> slopes, fixed, off;
        for (size_t a = 0; a < samples.size(); ++a)
            for (size_t b = 0; b < a; ++b) {
                const double from = samples[a].points[cut], to = samples[b].points[cut];
                if (std::abs(to - from) <= kLeastSpread * std::max(from, to)) continue;
                slopes.push_back((samples[b].seconds - samples[a].seconds) / (to - from));
            }
        // With few pairs, all may contain the same disturbed frame.
        if (slopes.size() < 3 * samples.size()) continue;
        any_spread = true;
        const double slope = std::max(median(slopes), 0.0);  // more points never cost less time
        for (const Sample& s : samples) fixed.push_back(s.seconds - slope * s.points[cut]);
        const double intercept = std::max(median(fixed), 0.0);
        for (const Sample& s : samples)
            off.push_back(std::abs(s.seconds - intercept - slope * s.points[cut]));
        if (const double error = median(off); error < least) {
            least = error;
            best = {intercept, {}};
            best.per_point[cut] = slope;
        }
    }
    if (any_spread) return best;
    std::vector<double> seconds, points;
    for (const Sample& s : samples) {
        seconds.push_back(s.seconds);
        points.push_back(std::max(s.points[0], 1.0));
    }
    best.per_point[0] = median(seconds) / median(points);
    return best;
}

std::optional<CostModel::Line> CostModel::line() const {
    if (frames_ == 0) return std::nullopt;
    Line sum;
    for (const auto& [name, samples] : passes_) {
        const Line pass = of_pass(samples);
        sum.fixed += pass.fixed;
        for (size_t cut = 0; cut < sum.per_point.size(); ++cut) sum.per_point[cut] += pass.per_point[cut];
    }
    return sum;
}

void FrameBudget::forget() {
    *this = FrameBudget(target_);
}

void FrameBudget::observe(const FrameStats& frame, ImageSize size) {
    if (frame.complete() < kWholeEnough) return;
    if (size.width != size_.width || size.height != size_.height) model_.forget();
    size_ = size;
    model_.observe(frame);
    const auto line = model_.line();
    drawn_ = {static_cast<double>(frame.view_points), static_cast<double>(frame.light_view_points),
              static_cast<double>(frame.light_points)};
    most_seen_ = std::max(most_seen_, drawn_[0]);
    const double others = line->at({0, drawn_[1], drawn_[2]}), slope = line->per_point[0];
    const double allowed = slope > 0           ? std::max(target_ - others, 0.0) / slope
                           : others <= target_ ? std::numeric_limits<double>::infinity()
                                               : 0.0;
    const double least = most_seen_ * kLeastView;
    // Fewer points may be drawn than the budget allows: nodes are on their way, or the view needs no more.
    const double next =
        std::max(least, std::clamp(allowed, drawn_[0] * kFall, std::max(drawn_[0], view_) * kRise));
    const bool held_down = view_ > 0 || allowed < drawn_[0];
    if (drawn_[0] > 0 && held_down && !(std::abs(next - view_) <= kCalm * view_)) view_ = next;

    slow_ = allowed < least ? slow_ + 1 : 0;
    fast_ = halvings_ > 0 && line->at(drawn_) < kSpare * target_ ? fast_ + 1 : 0;
    if (slow_ > kPatience && halvings_ < kMostHalvings) {
        ++halvings_;
        slow_ = 0;
    } else if (fast_ > kPatience) {
        --halvings_;
        fast_ = 0;
    }
}

CutBudgets FrameBudget::budgets(const CutBudgets& full) const {
    CutBudgets budgets = full;
    if (view_ > 0 && view_ < static_cast<double>(full.view))
        budgets.view = std::max<uint64_t>(1, static_cast<uint64_t>(view_));
    budgets.light_view = std::max<uint64_t>(1, full.light_view >> halvings_);
    budgets.light = std::max<uint64_t>(1, full.light >> halvings_);
    return budgets;
}

}  // namespace lucarne::viewer
