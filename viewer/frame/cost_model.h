#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// Points that cuts draw: the view's, the lights' views', the light cut's.
using CutPoints = std::array<double, 3>;

/// What a frame costs, learned from the last ones, pass by pass: the seconds of a pass are a line over the
/// points of whichever cut explains them best. The lines are those of Theil (1950) and Sen (1968), medians of
/// the slopes of all pairs: up to a quarter of the frames may be disturbed in any way.
class CostModel {
 public:
    void observe(const FrameStats& frame);
    void forget();  ///< another size, engine or setting

    /// Seconds = fixed + per_point . points. Empty before the first frame. Where a cut has always been of one
    /// size nothing is known of what its points cost; where all have, the view's count in proportion, which
    /// leads to the target as well, in more steps.
    struct Line {
        double fixed = 0;
        CutPoints per_point{};
        double at(const CutPoints& points) const;
    };
    std::optional<Line> line() const;

 private:
    struct Sample {
        CutPoints points;
        double seconds;
    };
    static Line of_pass(const std::deque<Sample>& samples);

    size_t frames_ = 0;
    std::map<std::string, std::deque<Sample>, std::less<>> passes_;
};

/// Budgets that hold frames to a time. The view cut follows it from frame to frame; the lights' cuts, whose
/// change makes an engine light everything anew, go down by halves only where the view's least is still too
/// slow, and up again where there is time to spare.
class FrameBudget {
 public:
    /// `target`: seconds a frame.
    explicit FrameBudget(double target) : target_(target) {}
    /// A frame of a motion, drawn under budgets().
    void observe(const FrameStats& frame, ImageSize size);
    void forget();
    /// At most `full`, each.
    CutBudgets budgets(const CutBudgets& full) const;
    double target() const { return target_; }

 private:
    double target_;
    CostModel model_;
    ImageSize size_{};
    CutPoints drawn_{};
    double view_ = 0;  ///< points; 0: not limited yet
    double most_seen_ = 0;
    int halvings_ = 0, slow_ = 0, fast_ = 0;
};

}  // namespace lucarne::viewer
