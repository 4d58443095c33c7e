#include "viewer/overlay/draw_marks.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <imgui.h>

namespace lucarne::viewer {
namespace {

uint8_t byte_of(float value) {
    return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
}

class Canvas {
 public:
    explicit Canvas(io::Image8& picture) : picture_(picture) {}

    void blend(int64_t x, int64_t y, const glm::vec3& colour, float opacity) {
        if (x < 0 || y < 0 || x >= picture_.width || y >= picture_.height) return;
        const size_t pixel = static_cast<size_t>(y) * picture_.width + static_cast<size_t>(x);
        float share = opacity;  // weight of the mark's colour in the mixture
        if (!picture_.alpha.empty()) {
            // The "over" operator of Porter & Duff ("Compositing digital images", 1984) for non-premultiplied
            // colours.
            uint8_t& alpha = picture_.alpha[pixel];
            const float both = opacity + static_cast<float>(alpha) / 255.0f * (1 - opacity);
            if (both <= 0) return;
            share = opacity / both;
            alpha = byte_of(255.0f * both);
        }
        for (int i = 0; i < 3; ++i) {
            uint8_t& channel = picture_.bytes[3 * pixel + static_cast<size_t>(i)];
            channel = byte_of(glm::mix(static_cast<float>(channel), 255.0f * colour[i], share));
        }
    }
    void area(const Mark& mark) {
        const glm::dvec2 low = clamped(glm::min(mark.from, mark.to)),
                         high = clamped(glm::max(mark.from, mark.to));
        for (int64_t y = std::lround(low.y); y < std::lround(high.y); ++y)
            for (int64_t x = std::lround(low.x); x < std::lround(high.x); ++x)
                blend(x, y, mark.colour, mark.opacity);
    }
    void line(const Mark& mark, int width) {
        const glm::dvec2 from = clamped(mark.from), way = clamped(mark.to) - from;
        const auto steps = static_cast<int>(std::ceil(std::max(std::abs(way.x), std::abs(way.y))));
        for (int i = 0; i <= steps; ++i) {
            const glm::dvec2 at = from + way * (static_cast<double>(i) / std::max(steps, 1));
            for (int y = 0; y < width; ++y)
                for (int x = 0; x < width; ++x)
                    blend(std::lround(at.x) + x, std::lround(at.y) + y, mark.colour, mark.opacity);
        }
    }

 private:
    /// Clamps a place to within one picture width of the picture, so that marks far outside take no time.
    glm::dvec2 clamped(const glm::dvec2& at) const {
        const glm::dvec2 size(picture_.width, picture_.height);
        return glm::clamp(at, -size, 2.0 * size);
    }
    io::Image8& picture_;
};

/// The glyphs of the interface's font as pixels.
class Letters {
 public:
    Letters() {
        atlas_.AddFontDefault();
        int height = 0;
        atlas_.GetTexDataAsAlpha8(&alpha_, &width_, &height);
        height_ = height;
    }
    void write(Canvas& canvas, const Mark& mark, int scale) {
        double x = mark.from.x;
        for (const char c : mark.text) {
            const ImFontGlyph* glyph =
                atlas_.Fonts[0]->FindGlyph(static_cast<ImWchar>(static_cast<unsigned char>(c)));
            if (!glyph) continue;
            const auto left = static_cast<int>(std::lround(glyph->U0 * static_cast<float>(width_)));
            const auto top = static_cast<int>(std::lround(glyph->V0 * static_cast<float>(height_)));
            const auto right = static_cast<int>(std::lround(glyph->U1 * static_cast<float>(width_)));
            const auto bottom = static_cast<int>(std::lround(glyph->V1 * static_cast<float>(height_)));
            for (int v = 0; v < (bottom - top) * scale; ++v)
                for (int u = 0; u < (right - left) * scale; ++u) {
                    const int at = (top + v / scale) * width_ + left + u / scale;
                    const float opacity = static_cast<float>(alpha_[at]) / 255.0f;
                    canvas.blend(std::lround(x + glyph->X0 * static_cast<float>(scale)) + u,
                                 std::lround(mark.from.y + glyph->Y0 * static_cast<float>(scale)) + v,
                                 mark.colour, opacity);
                }
            x += glyph->AdvanceX * static_cast<float>(scale);
        }
    }

 private:
    ImFontAtlas atlas_;
    unsigned char* alpha_ = nullptr;
    int width_ = 0, height_ = 0;
};

}  // namespace

void draw_marks(std::span<const Mark> marks, int scale, io::Image8& picture) {
    if (marks.empty()) return;
    Canvas canvas(picture);
    Letters letters;
    for (const Mark& mark : marks) {
        if (mark.kind == Mark::Kind::area) canvas.area(mark);
        if (mark.kind == Mark::Kind::line) canvas.line(mark, scale);
        if (mark.kind == Mark::Kind::text) letters.write(canvas, mark, scale);
    }
}

}  // namespace lucarne::viewer
