#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/compare/metrics.h"
#include "io/core/file.h"
#include "io/image/image.h"
#include "viewer/commands/commands.h"

namespace lucarne::viewer {
namespace {

struct CompareOptions {
    std::string picture, reference, json;
    bool overwrite = false;
};

Result<void> compare(const CompareOptions& options) {
    LUCARNE_ASSIGN(const io::Image picture, io::read_exr(options.picture));
    LUCARNE_ASSIGN(const io::Image reference, io::read_exr(options.reference));
    if (picture.width != reference.width || picture.height != reference.height)
        return rejected(options.picture,
                        fmt::format("is {}x{} and {} is {}x{}", picture.width, picture.height,
                                    options.reference, reference.width, reference.height),
                        "render both at the same --size");
    LUCARNE_ASSIGN(const gi::ImageMetrics metrics, gi::compare_images(picture.pixels, reference.pixels));
    fmt::print("mean luminance {:.6g} against {:.6g} ({:+.2f} %), relMSE {:.4g}, RMSE {:.4g}\n",
               metrics.mean_luminance, metrics.reference_mean_luminance, 100 * metrics.luminance_error,
               metrics.rel_mse, metrics.rmse);
    if (options.json.empty()) return {};
    const nlohmann::json report = {{"mean_luminance", metrics.mean_luminance},
                                   {"reference_mean_luminance", metrics.reference_mean_luminance},
                                   {"luminance_error", metrics.luminance_error},
                                   {"rel_mse", metrics.rel_mse},
                                   {"rmse", metrics.rmse}};
    LUCARNE_ASSIGN(auto file, OutputFile::create(options.json, options.overwrite));
    LUCARNE_TRY(file.append(report.dump(2) + "\n"));
    return file.commit();
}

}  // namespace

void add_compare(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<CompareOptions>();
    auto* command = app.add_subcommand("compare", "Hold a picture of linear radiance against a reference");
    command->add_option("picture", options->picture, "EXR")->required()->type_name("A.exr");
    command->add_option("reference", options->reference, "EXR: the truth")->required()->type_name("B.exr");
    command->add_option("--json", options->json, "The figures, machine-readable")->type_name("FILE");
    command->add_flag("--overwrite", options->overwrite, "Replace a file that exists");
    command->callback([options, &chosen] { chosen = [options] { return compare(*options); }; });
}

}  // namespace lucarne::viewer
