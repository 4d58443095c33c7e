#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gi/options.h"

// The options of the engine `paint`: one of each kind, and one on which what it computes in advance depends.
namespace lucarne::gi::paint {

enum class Pattern { plain, stripes, grey, mean };
inline constexpr std::array<std::string_view, 4> kPatterns = {"plain", "stripes", "grey", "mean"};

inline constexpr Option<glm::dvec3> kTint{
    {.kind = OptionKind::colour,
     .key = "tint",
     .label = "tint",
     .help = "Colour of all surfaces",
     .defaults = {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}}};
inline constexpr Option<double> kGain{{.kind = OptionKind::number,
                                       .key = "paint_gain",
                                       .label = "gain",
                                       .help = "Factor of the colour",
                                       .cost = "nothing",
                                       .least = 0.5,
                                       .most = 8,
                                       .slider = {0.5, 8},
                                       .defaults = {1.0, 1.0, 1.0}}};
inline constexpr Option<uint32_t> kWidth{{.kind = OptionKind::integer,
                                          .key = "stripe_width",
                                          .label = "stripe width",
                                          .help = "Pixels of a stripe",
                                          .least = 1,
                                          .most = 64,
                                          .slider = {1, 16},
                                          .defaults = {int64_t{8}, int64_t{4}, int64_t{2}},
                                          .cheaper = 1}};
inline constexpr Option<Pattern> kPattern{
    {.kind = OptionKind::choice,
     .key = "pattern",
     .label = "pattern",
     .help = "What is painted: the tint, stripes of it, its luminance, or the mean colour of the scan",
     .choices = kPatterns,
     .defaults = {int64_t{0}, int64_t{0}, int64_t{0}}}};
inline constexpr Option<bool> kPaintSky{{.kind = OptionKind::flag,
                                         .key = "paint_sky",
                                         .label = "sky as well",
                                         .help = "Paint where no surface is, too",
                                         .defaults = {false, false, false}}};
inline constexpr Option<double> kMeanScale{{.kind = OptionKind::number,
                                            .key = "mean_scale",
                                            .label = "scale",
                                            .help = "Factor of the mean colour, computed in advance",
                                            .least = 1,
                                            .most = 4,
                                            .slider = {1, 4},
                                            .defaults = {1.0, 1.0, 1.0}}};

}  // namespace lucarne::gi::paint
