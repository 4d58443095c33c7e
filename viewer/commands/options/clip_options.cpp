#include "viewer/commands/options/clip_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "viewer/commands/options/numbers.h"

namespace lucarne::viewer {
namespace {

Result<gi::ClipBox> parse_box(std::string_view option, const std::string& text, bool inverted) {
    const bool turned = std::ranges::count(text, ',') == 6;
    LUCARNE_ASSIGN(const auto n, parse_numbers(option, text, ',', turned ? 7 : 6));
    gi::ClipBox box{{n[0], n[1], n[2]},
                    {n[3], n[4], n[5]},
                    turned ? glm::radians(std::remainder(n[6], 360.0)) : 0,
                    inverted};
    if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z)
        return bad_arguments(std::string(option),
                             fmt::format("'{}' has its second corner below its first", text),
                             "give x0,y0,z0,x1,y1,z1 with the smaller ones first");
    return box;
}

}  // namespace

void add_clip_options(Arguments& command, ClipOptions& options) {
    command
        .add(
            "--clip-box", options.boxes,
            "Keep only points inside the box (or inside any of several); DEGREES turns it about the vertical")
        .repeatable()
        .type_name("X0,Y0,Z0,X1,Y1,Z1[,DEGREES]");
    command.add("--clip-outside", options.outside, "Keep only points outside the box")
        .repeatable()
        .type_name("X0,Y0,Z0,X1,Y1,Z1[,DEGREES]");
    command.add("--clip-plane", options.planes, "Keep only points on the side that the normal points to")
        .repeatable()
        .type_name("PX,PY,PZ,NX,NY,NZ");
}

Result<void> apply(const ClipOptions& options, gi::Clip& clip) {
    for (const auto& text : options.boxes) {
        LUCARNE_ASSIGN(const gi::ClipBox box, parse_box("--clip-box", text, false));
        clip.boxes.push_back(box);
    }
    for (const auto& text : options.outside) {
        LUCARNE_ASSIGN(const gi::ClipBox box, parse_box("--clip-outside", text, true));
        clip.boxes.push_back(box);
    }
    for (const auto& text : options.planes) {
        LUCARNE_ASSIGN(const auto n, parse_numbers("--clip-plane", text, ',', 6));
        const gi::ClipPlane plane{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
        if (!(glm::length(plane.normal) > 0))
            return bad_arguments("--clip-plane", "the normal points nowhere");
        clip.planes.push_back(plane);
    }
    if (clip.boxes.size() + clip.planes.size() > gi::kMostClips)
        return bad_arguments("--clip-box", fmt::format("more than {} boxes and planes", gi::kMostClips));
    return {};
}

}  // namespace lucarne::viewer
