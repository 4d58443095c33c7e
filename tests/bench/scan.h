// Virtual scans, and pictures of them rendered by the program, for benchmarks that compare `vpl` with the
// reference.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/vec4.hpp>

#include "io/core/error.h"
#include "io/image/image.h"

namespace lucarne::bench {

inline std::string scene_file(const std::string& name) {
    return fmt::format("{}/data/scenes/{}.json", LUCARNE_SOURCE_DIR, name);
}

/// The cache of a virtual scan of a scene in `folder`.
class Scan {
 public:
    /// `sampling` are further options of `lucarne generate`.
    static Result<Scan> create(const std::string& scene, uint64_t points, const std::filesystem::path& folder,
                               const std::string& sampling = "--even --normals") {
        const Scan made(scene, folder);
        const std::string scan = folder / (scene + ".ply");
        LUCARNE_TRY(
            run(fmt::format("generate {} {} --points {} -o {} --overwrite", scene, sampling, points, scan)));
        LUCARNE_TRY(run("convert " + scan + " -o " + made.cache_ + " --overwrite"));
        std::filesystem::remove(scan);
        return made;
    }

    const std::string& cache() const { return cache_; }
    /// Renders further pictures with another scene file, and names them after it.
    void light_by(const std::filesystem::path& file) {
        scene_ = file.stem();
        lit_by_ = file;
    }

    Result<std::vector<glm::vec4>> picture(const std::string& name, const std::string& arguments) const {
        LUCARNE_ASSIGN(const std::string file, render(name + ".exr", arguments));
        LUCARNE_ASSIGN(io::Image image, io::read_exr(file));
        return std::move(image.pixels);
    }

    struct Truth {
        std::vector<glm::vec4> whole, first, second;
    };
    Result<Truth> truth(const std::string& name, const std::string& arguments) const {
        LUCARNE_ASSIGN(const std::string file,
                       render(name + ".exr", "--engine reference --layers " + arguments));
        const std::string stem = file.substr(0, file.size() - 4);
        LUCARNE_ASSIGN(io::Image whole, io::read_exr(file));
        LUCARNE_ASSIGN(io::Image first, io::read_exr(stem + ".a.exr"));
        LUCARNE_ASSIGN(io::Image second, io::read_exr(stem + ".b.exr"));
        return Truth{std::move(whole.pixels), std::move(first.pixels), std::move(second.pixels)};
    }

    /// Renders the picture FOLDER/SCENE-NAME and returns its path. `name` includes the extension.
    Result<std::string> render(const std::string& name, const std::string& arguments) const {
        const std::string file = folder_ / (scene_ + "-" + name);
        LUCARNE_TRY(
            run("render " + cache_ + " -o " + file + " --overwrite --scene " + lit_by_ + " " + arguments));
        return file;
    }

 private:
    Scan(const std::string& scene, const std::filesystem::path& folder)
        : scene_(scene), lit_by_(scene_file(scene)), cache_(folder / (scene + ".luc")), folder_(folder) {}

    static Result<void> run(const std::string& arguments) {
        if (std::system((LUCARNE_BINARY " " + arguments + " > /dev/null").c_str()) != 0)
            return failed("lucarne " + arguments, "failed");
        return {};
    }

    std::string scene_, lit_by_, cache_;
    std::filesystem::path folder_;
};

}  // namespace lucarne::bench
