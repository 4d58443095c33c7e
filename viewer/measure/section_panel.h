#pragma once

#include <memory>

#include "viewer/measure/measuring.h"
#include "viewer/measure/section/profile_raster.h"

struct ImVec2;

namespace lucarne::viewer {

/// Draws the selected section. Keeps its dots from frame to frame.
class SectionPanel {
 public:
    void draw(const Measuring& model);

 private:
    void plot(const std::shared_ptr<const Section>& section, const ImVec2& corner, const ImVec2& size,
              const UnitChoice& units);

    std::shared_ptr<const Section> drawn_;
    uint32_t columns_ = 0, rows_ = 0;
    ProfileRaster raster_;
};

}  // namespace lucarne::viewer
