#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "viewer/measure/marks.h"
#include "viewer/picking/pick.h"

namespace lucarne::viewer {

/// Projects world points and lines to pixels of a window that the picture fills as in Window::show.
class OverlayLayout {
 public:
    OverlayLayout(const Picture& picture, const glm::dvec2& window, Overlay& overlay)
        : picture_(picture), overlay_(overlay) {
        const glm::dvec2 size(picture.size.width, picture.size.height);
        scale_ = std::max(window.x / size.x, window.y / size.y);
        corner_ = window / 2.0 - size * scale_ / 2.0;
    }

    void mark(const glm::dvec3& world, size_t measurement) {
        if (const Place at = place(world); at.there)
            overlay_.marks.push_back({at.pixel, at.hidden, measurement});
    }
    void label(const glm::dvec3& world, std::string text, size_t measurement) {
        if (const Place at = place(world); at.there)
            overlay_.labels.push_back({at.pixel, std::move(text), at.hidden, measurement});
    }
    /// Adds a line in pieces, each visible or hidden. Adjacent pieces of the same visibility are joined.
    void line(const glm::dvec3& from, const glm::dvec3& to, size_t measurement, int pieces = 48) {
        Place before = place(from);
        bool open = false;
        for (int i = 1; i <= pieces; ++i) {
            const Place at = place(from + (to - from) * (static_cast<double>(i) / pieces));
            const bool whole = at.there && before.there;
            const bool hidden_piece = at.hidden && before.hidden;
            if (whole && open && overlay_.lines.back().hidden == hidden_piece)
                overlay_.lines.back().to = at.pixel;
            else if (whole)
                overlay_.lines.push_back({before.pixel, at.pixel, hidden_piece, measurement});
            open = whole;
            before = at;
        }
    }

 private:
    struct Place {
        bool there = false;  ///< false: behind the camera, or too far to the side
        bool hidden = false;
        glm::dvec2 pixel{0.0};
    };
    Place place(const glm::dvec3& world) const {
        const auto projected = project(picture_, world);
        if (!projected || glm::length(projected->pixel) > 1e6) return {};
        return {true, hidden(picture_, *projected), corner_ + projected->pixel * scale_};
    }

    const Picture& picture_;
    Overlay& overlay_;
    double scale_ = 1;
    glm::dvec2 corner_{0.0};
};

}  // namespace lucarne::viewer
