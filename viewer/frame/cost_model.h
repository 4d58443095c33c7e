#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// Points drawn by the view cut, the lights' view cuts and the light cut.
using CutPoints = std::array<double, 3>;

/// A model of a frame's cost, learned from the last frames, pass by pass. The seconds of a pass are a line
/// over the points of the cut that explains them best. The lines are medians of the slopes of all pairs
/// (Theil 1950, Sen 1968), so up to a quarter of the frames may be disturbed in any way.
class CostModel {
 public:
    void observe(const FrameStats& frame);
    void forget();  ///< call for another size, engine or setting

    /// The model: seconds = fixed + dot(per_point, points). If a cut has always had the same size, the cost
    /// of its points is unknown (0). If all cuts have, the time is taken as proportional to the view's
    /// points, which also reaches the target, in more steps.
    struct Line {
        double fixed = 0;
        CutPoints per_point{};
        double at(const CutPoints& points) const;
    };
    std::optional<Line> line() const;  ///< empty before the first frame

 private:
    struct Sample {
        CutPoints points;
        double seconds;
    };
    static Line of_pass(const std::deque<Sample>& samples);

    size_t frames_ = 0;
    std::map<std::string, std::deque<Sample>, std::less<>> passes_;
};

/// The share of a frame's time in which light that outlasts the frame is made (FrameRequest::light_budget).
inline constexpr double kLightShare = 0.3;

/// Chooses budgets that keep frames to a target time. The view's budget changes from frame to frame. A change
/// of the lights' cuts makes an engine light everything again; so their budgets are halved only if the least
/// view is still too slow, and doubled again when there is time to spare.
class FrameBudget {
 public:
    /// `target`: seconds a frame.
    explicit FrameBudget(double target) : target_(target) {}
    /// Observes a frame of a motion that was drawn with budgets().
    void observe(const FrameStats& frame, ImageSize size);
    void forget();
    /// Returns budgets of at most `full`.
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
