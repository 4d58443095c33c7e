#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "gi/scene/scene.h"
#include "viewer/measure/list.h"
#include "viewer/opening/moods.h"
#include "viewer/publish/editor.h"

namespace lucarne::viewer {

struct ViewModel;

/// The user's work that can be undone.
struct UndoState {
    std::vector<gi::SceneLight> lights;
    std::optional<Mood> mood;
    std::vector<gi::SceneMaterial> materials;
    std::shared_ptr<const gi::Environment> sky;
    bool sky_on = true;
    glm::dvec3 background{0.0};
    gi::Albedo albedo;
    gi::Clip clip;
    gi::Look look;  ///< without its clip
    std::optional<double> exposure_ev;
    gi::ToneMap tone_map = gi::ToneMap::filmic;
    glm::dvec3 white{1.0};
    std::optional<gi::ValueRange> luminance;
    std::optional<gi::Comparison> comparison;
    std::string engine;
    MeasureList::State measurements;
    PathEditor::State flythrough;

    auto parts() {
        return std::tie(lights, mood, materials, sky, sky_on, background, albedo, clip, look, exposure_ev,
                        tone_map, white, luminance, comparison, engine, measurements, flythrough);
    }
    bool operator==(const UndoState&) const = default;
};

/// The steps of the user's work in the order in which they were made, whichever feature made them. Finds them
/// by comparing the model with its last known state, so features do not report their changes. A step restores
/// only the parts that it changed.
class UndoHistory {
 public:
    static constexpr size_t kMostSteps = 100;
    static constexpr size_t kMostSkyBytes = size_t{1} << 29;  ///< of all pictures of skies that it holds

    /// Records what has changed since the last call as one step. Call once a frame, but not during a drag or
    /// while a text is typed, so that each of these is one step.
    void follow(ViewModel& model);
    /// Calls `change`, which the user has not asked for: it is no step.
    template <class Change>
    void without_step(ViewModel& model, const Change& change) {
        UndoState before = state_of(model);
        change();
        accept(before, state_of(model));
    }
    /// Forgets all steps.
    void restart(ViewModel& model);

    bool can_undo() const { return !done_.empty(); }
    bool can_redo() const { return !undone_.empty(); }
    void undo(ViewModel& model) { step(model, done_, undone_, true); }
    void redo(ViewModel& model) { step(model, undone_, done_, false); }

 private:
    struct Step {
        UndoState before, after;
        std::string what;
    };
    static UndoState state_of(ViewModel& model);
    void accept(UndoState& before, UndoState after);
    void change(ViewModel& model, UndoState& from, UndoState& to);
    void limit();
    /// Moves the last step from one list to the other.
    void step(ViewModel& model, std::vector<Step>& from, std::vector<Step>& to, bool back);

    std::optional<UndoState> now_;
    double metres_per_unit_ = 1;  ///< of the measurements
    std::vector<Step> done_, undone_;
};

}  // namespace lucarne::viewer
