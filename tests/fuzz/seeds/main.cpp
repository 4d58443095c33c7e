// fuzz_seeds FOLDER: fills FOLDER/<target>/ with small valid files, made by Lucarne's own writers and by
// hand. Scenes and camera paths are those of data/.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "io/formats/scan.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {

Seeds::Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
}

void Seeds::add(std::string_view name, std::string_view bytes) const {
    std::ofstream out(folder_ / name, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush())
        throw std::runtime_error(fmt::format("{} cannot be written", (folder_ / name).string()));
}

void Seeds::add_scan(std::string_view name, std::string_view bytes) const {
    add(name, bytes);
    const auto refuse = [&](const std::string& why) {
        throw std::runtime_error(fmt::format("the seed {} is refused: {}", (folder_ / name).string(), why));
    };
    const auto source = io::open_scan(folder_ / name, {"", true, {0, 500, false}});
    if (!source) return refuse(source.error().line());
    const auto reader = (*source)->open();
    if (!reader) return refuse(reader.error().line());
    io::PointBatch batch;
    for (;;) {
        const auto got = (*reader)->read(batch, 1000);
        if (!got) return refuse(got.error().line());
        if (*got == 0) return;
    }
}

std::string Seeds::taken(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(in), {});
    std::filesystem::remove(path);
    return bytes;
}

namespace {

/// Makes a project of each scene of a folder, with measurements and a flythrough.
void project_seeds(const std::filesystem::path& data, const Seeds& seeds) {
    const auto text = [](const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    const std::string measurements =
        R"({"measurements": [{"kind": "distance", "name": "wall", "points": [{"position": [0, 0, 1],
            "coordinates": ["0", "0", "1"]}, {"position": [4, 0, 1], "coordinates": ["4", "0", "1"]}]}]})";
    for (const auto& scene : std::filesystem::directory_iterator(data / "scenes")) {
        if (scene.path().extension() != ".json") continue;
        std::string project =
            R"({"version": 1, "scans": ["/scans/a.las", ["b.laz", "c.laz"]], "mood": "evening")";
        project += ", \"scene\": " + text(scene.path()) + ", \"measurements\": " + measurements;
        for (const auto& path : std::filesystem::directory_iterator(data / "flythroughs"))
            if (path.path().filename() == scene.path().filename())
                project += ", \"flythrough\": " + text(path.path());
        seeds.add(scene.path().filename().string(), project + "}");
    }
}

void make_all(const std::filesystem::path& folder) {
    const std::filesystem::path data = LUCARNE_SOURCE_DIR "/data";
    // Without `recursive` nothing inside a folder is copied.
    const auto copies =
        std::filesystem::copy_options::overwrite_existing | std::filesystem::copy_options::recursive;
    std::filesystem::create_directories(folder);
    std::filesystem::copy(data / "scenes", folder / "scene", copies);
    std::filesystem::copy(data / "flythroughs", folder / "path", copies);
    bake_seeds(Seeds(folder / "bake"));
    cache_seeds(Seeds(folder / "cache"));
    codec_seeds(Seeds(folder / "codec"));
    copc_seeds(Seeds(folder / "copc"));
    e57_seeds(Seeds(folder / "e57"));
    las_seeds(Seeds(folder / "las"));
    laz_seeds(Seeds(folder / "laz"));
    obj_seeds(Seeds(folder / "obj"));
    pcd_seeds(Seeds(folder / "pcd"));
    picture_seeds(Seeds(folder / "exr"), Seeds(folder / "hdr"), Seeds(folder / "png"),
                  Seeds(folder / "jpeg"));
    project_seeds(data, Seeds(folder / "project"));
    ply_seeds(Seeds(folder / "ply"));
    text_seeds(Seeds(folder / "text"));
}

}  // namespace
}  // namespace lucarne::fuzz

int main(int count, char** arguments) {
    if (count != 2) return 2;
    try {
        lucarne::fuzz::make_all(std::filesystem::absolute(arguments[1]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "fuzz_seeds: %s\n", error.what());
        return 1;
    }
    return 0;
}
