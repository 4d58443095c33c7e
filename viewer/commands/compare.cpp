#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/compare/edges.h"
#include "gi/compare/error_picture.h"
#include "gi/compare/flip.h"
#include "gi/compare/metrics.h"
#include "gi/post/exposure.h"
#include "gi/post/tone_map.h"
#include "io/core/log.h"
#include "io/core/terminal.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/image/image.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/outputs.h"

namespace lucarne::viewer {
namespace {

using nlohmann::json;

struct CompareOptions {
    std::string picture, reference, gbuffer, json, error_picture;
    std::string error_kind = "flip";
    std::vector<std::string> halves;
    std::optional<double> exposure;
    bool overwrite = false;
};

struct Pictures {
    io::Image picture, reference;
    std::vector<io::Image> halves;  ///< none or two half-sample images of the reference
    std::optional<io::Image> gbuffer;
};

/// Reads a picture. If `same_size` is given, a picture of another size is an error.
Result<io::Image> read_alike(const std::string& path, const io::Image* same_size) {
    LUCARNE_ASSIGN(io::Image image, io::read_exr(path));
    if (same_size && (image.width != same_size->width || image.height != same_size->height))
        return rejected(path,
                        fmt::format("is {}x{}, the first picture {}x{}", image.width, image.height,
                                    same_size->width, same_size->height),
                        "render both at the same --size");
    return image;
}

Result<Pictures> read_pictures(const CompareOptions& options) {
    Pictures read;
    const auto radiance = [&](const std::string& path, bool first = false) -> Result<io::Image> {
        LUCARNE_ASSIGN(io::Image image, read_alike(path, first ? nullptr : &read.picture));
        LUCARNE_TRY(gi::check_radiance(image.pixels, image.width, path));
        return image;
    };
    LUCARNE_ASSIGN(read.picture, radiance(options.picture, true));
    for (const std::string& half : options.halves) {
        LUCARNE_ASSIGN(io::Image image, radiance(half));
        read.halves.push_back(std::move(image));
    }
    if (!options.reference.empty()) {
        LUCARNE_ASSIGN(read.reference, radiance(options.reference));
    } else {
        read.reference = read.halves[0];
        for (size_t i = 0; i < read.reference.pixels.size(); ++i)
            read.reference.pixels[i] = 0.5f * (read.halves[0].pixels[i] + read.halves[1].pixels[i]);
    }
    if (!options.gbuffer.empty()) {
        LUCARNE_ASSIGN(read.gbuffer, read_alike(options.gbuffer, &read.picture));
    }
    return read;
}

/// Warns if the pictures show different surfaces, for example those of two presets. On a scan the nearest
/// point of many pixels is another one then, so the difference is no error of the engine.
bool warn_of_other_surfaces(const Pictures& pictures) {
    const std::string &shown = pictures.picture.surfaces, &expected = pictures.reference.surfaces;
    if (shown.empty() || expected.empty() || shown == expected) return false;
    log::warn(
        "the pictures show different surfaces ({}; the reference: {}), and this counts as error: "
        "render both with the same --preset and --points",
        shown, expected);
    return true;
}

/// Error metrics over all pixels or over the pixels of a mask.
struct Figures {
    gi::ImageMetrics metrics;
    double flip = 0;  ///< mean
    std::optional<gi::HalvesError> halves;
};

Result<Figures> figures(const Pictures& pictures, std::span<const float> flip,
                        std::span<const uint8_t> mask) {
    Figures result;
    LUCARNE_ASSIGN(result.metrics,
                   gi::compare_images(pictures.picture.pixels, pictures.reference.pixels, mask));
    for (size_t i = 0; i < flip.size(); ++i)
        if (mask.empty() || mask[i]) result.flip += flip[i];
    result.flip /= static_cast<double>(result.metrics.pixels);
    if (!pictures.halves.empty()) {
        LUCARNE_ASSIGN(result.halves,
                       gi::compare_with_halves(pictures.picture.pixels, pictures.halves[0].pixels,
                                               pictures.halves[1].pixels, mask));
    }
    return result;
}

void print(const char* which, const Figures& f) {
    const auto& m = f.metrics;
    print_line("{}: {} pixels, mean luminance {:.6g} against {:.6g} ({:+.2f} %)", which, m.pixels,
               m.mean_luminance, m.reference_mean_luminance, 100 * m.luminance_error);
    print_line(
        "  relMSE {:.4g}, without the worst {} pixels {:.4g}, RMSE {:.4g}, p99 of the relative error {:.4g}, "
        "FLIP {:.4g}",
        m.rel_mse, m.trimmed_pixels, m.rel_mse_trimmed, m.rmse, m.p99, f.flip);
    if (f.halves)
        print_line("  relMSE free of the reference's noise {:.4g} +- {:.2g}; the noise itself {:.2g}",
                   f.halves->rel_mse, f.halves->standard_error, f.halves->reference_rel_mse);
}

json to_json(const Figures& f) {
    const auto& m = f.metrics;
    json out = {{"pixels", m.pixels},
                {"mean_luminance", m.mean_luminance},
                {"reference_mean_luminance", m.reference_mean_luminance},
                {"luminance_error", m.luminance_error},
                {"rel_mse", m.rel_mse},
                {"rel_mse_trimmed", m.rel_mse_trimmed},
                {"trimmed_pixels", m.trimmed_pixels},
                {"rmse", m.rmse},
                {"p99", m.p99},
                {"flip", f.flip}};
    if (f.halves)
        out["halves"] = {{"rel_mse", f.halves->rel_mse},
                         {"rel_mse_trimmed", f.halves->rel_mse_trimmed},
                         {"standard_error", f.halves->standard_error},
                         {"reference_rel_mse", f.halves->reference_rel_mse}};
    return out;
}

Result<void> write_error_picture(const CompareOptions& options, const Pictures& pictures,
                                 std::span<const float> flip) {
    const io::Image8 picture = options.error_kind == "signed"
                                   ? gi::signed_picture(pictures.picture, pictures.reference)
                                   : gi::magma_picture(flip, pictures.picture.width);
    return io::write_png(options.error_picture, picture, options.overwrite);
}

Result<void> compare(const CompareOptions& options) {
    if (options.reference.empty() && options.halves.empty())
        return bad_arguments("compare", "there is nothing to compare with",
                             "name a second picture or --halves");
    auto inputs = options.halves;
    inputs.insert(inputs.end(), {options.picture, options.reference, options.gbuffer});
    LUCARNE_TRY(check_outputs({options.json, options.error_picture}, options.overwrite, inputs));
    LUCARNE_ASSIGN(const Pictures pictures, read_pictures(options));

    // Both pictures get the same exposure; otherwise FLIP could not tell a dark picture from a bright one.
    const double ev =
        options.exposure ? *options.exposure : gi::log_average_exposure(pictures.reference.pixels);
    const auto shown = [&](const io::Image& image) {
        return gi::tone_map(image.pixels, gi::ToneMap::filmic, {ev});
    };
    const auto flip =
        gi::flip_errors(shown(pictures.picture), shown(pictures.reference), pictures.picture.width);
    const auto edges =
        pictures.gbuffer ? gi::gbuffer_edges(*pictures.gbuffer) : gi::luminance_edges(pictures.reference);

    LUCARNE_ASSIGN(const Figures all, figures(pictures, flip, {}));
    print("all", all);
    json report = to_json(all);
    report["exposure_ev"] = ev;
    report["other_surfaces"] = warn_of_other_surfaces(pictures);
    const char* source = pictures.gbuffer ? "G-buffer" : "luminance";
    report["edges"] = {{"from", source}, {"pixels", 0}};
    if (std::find(edges.begin(), edges.end(), 1) != edges.end()) {
        LUCARNE_ASSIGN(const Figures at_edges, figures(pictures, flip, edges));
        print(pictures.gbuffer ? "edges of depth and normal" : "edges of the reference's luminance",
              at_edges);
        report["edges"].update(to_json(at_edges));
    } else {
        print_line("no edges in the {}", source);
    }
    if (!options.error_picture.empty()) LUCARNE_TRY(write_error_picture(options, pictures, flip));
    if (options.json.empty()) return {};
    return write_file(options.json, json_text(report), options.overwrite);
}

}  // namespace

void add_compare(CommandLine& line) {
    auto options = std::make_shared<CompareOptions>();
    Arguments command = line.add("compare", "Compare a picture of linear radiance with a reference");
    command.add("picture", options->picture, "EXR").required().type_name("A.exr");
    command.add("reference", options->reference, "EXR: the reference; by default the mean of --halves")
        .type_name("B.exr");
    command
        .add("--halves", options->halves,
             "Two independent halves of the reference, for an error without the reference's noise")
        .values(2)
        .type_name("R1.exr R2.exr");
    command
        .add("--gbuffer", options->gbuffer,
             "Output of render --gbuffer: find edges by depth and normal instead of luminance")
        .type_name("G.exr");
    command
        .add("--exposure", options->exposure,
             "Exposure of both pictures for FLIP, stops; by default measured from the reference")
        .range(-64.0, 64.0)
        .type_name("EV");
    command.add("--error-picture", options->error_picture, "Write a picture of the error")
        .type_name("FILE.png");
    command
        .add("--error-kind", options->error_kind,
             "Kind of the error picture: FLIP, or signed luminance (blue: too dark, red: too bright)")
        .one_of({"flip", "signed"})
        .show_default();
    command.add("--json", options->json, "Write the figures as JSON").type_name("FILE");
    command.flag("--overwrite", options->overwrite, "Replace files that exist");
    command.run([options] { return compare(*options); });
}

}  // namespace lucarne::viewer
