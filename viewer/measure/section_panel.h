#pragma once

#include <memory>

#include "viewer/measure/profile_raster.h"
#include "viewer/window/view_model.h"

struct ImVec2;

namespace lucarne::viewer {

/// Draws the selected section. Keeps its dots from frame to frame.
class SectionPanel {
 public:
    void draw(ViewModel& model);

 private:
    void plot(const std::shared_ptr<const Section>& section, const ImVec2& corner, const ImVec2& size,
              const UnitChoice& units);

    std::shared_ptr<const Section> drawn_;
    uint32_t columns_ = 0, rows_ = 0;
    ProfileRaster raster_;
};

}  // namespace lucarne::viewer
