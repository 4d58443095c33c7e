// Written scenes are read back unchanged.
#include <filesystem>
#include <random>

#include <glm/trigonometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/scene.h"
#include "io/files/json.h"
#include "io/image/image.h"
#include "tests/temporary_folder.h"

namespace lucarne::gi {
namespace {

void expect_same(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.lights, b.lights);
    EXPECT_EQ(a.materials, b.materials);
    EXPECT_EQ(a.cameras, b.cameras);
    EXPECT_EQ(a.exposure_ev, b.exposure_ev);
    EXPECT_EQ(a.tone_map, b.tone_map);
    EXPECT_EQ(a.white, b.white);
    EXPECT_EQ(a.luminance, b.luminance);
    EXPECT_EQ(a.background, b.background);
    EXPECT_EQ(a.environment_on, b.environment_on);
    EXPECT_EQ(a.albedo, b.albedo);
    EXPECT_EQ(a.look, b.look);
    EXPECT_EQ(a.comparison, b.comparison);
    EXPECT_EQ(a.render, b.render);
    ASSERT_EQ(a.environment == nullptr, b.environment == nullptr);
    if (!a.environment) return;
    EXPECT_EQ(a.environment->texels, b.environment->texels);
    EXPECT_EQ(a.environment->rotation, b.environment->rotation);
    EXPECT_EQ(a.environment->scale, b.environment->scale);
    EXPECT_EQ(a.environment->image.lexically_normal(), b.environment->image.lexically_normal());
}

void expect_round_trip(const Scene& scene, const std::filesystem::path& folder) {
    const std::string text = write_scene(scene, folder);
    const auto again = parse_scene(text, "written.json", folder);
    ASSERT_TRUE(again) << again.error().line() << '\n' << text;
    expect_same(*again, scene);
    EXPECT_EQ(write_scene(*again, folder), text);
}

TEST(SceneWriter, EveryScenesFileComesBackTheSame) {
    const std::filesystem::path folder = LUCARNE_SOURCE_DIR "/data/scenes";
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".json") continue;
        SCOPED_TRACE(entry.path());
        const auto scene = load_scene(entry.path());
        ASSERT_TRUE(scene) << scene.error().line();
        expect_round_trip(*scene, folder);
        ++files;
    }
    EXPECT_GE(files, 10u);
}

/// Random scenes with objects of every kind.
class Chance {
 public:
    explicit Chance(uint32_t seed) : random_(seed) {}
    double number(double least, double most) {
        return std::uniform_real_distribution<>(least, most)(random_);
    }
    size_t below(size_t count) { return std::uniform_int_distribution<size_t>(0, count - 1)(random_); }
    bool coin() { return below(2) == 1; }
    glm::dvec3 vector(double least, double most) {
        return {number(least, most), number(least, most), number(least, most)};
    }

    nlohmann::json light() {
        static constexpr const char* kTypes[] = {"spot", "point", "directional", "rectangle", "disc"};
        const size_t type = below(5);
        nlohmann::json light = {{"type", kTypes[type]}, {"on", coin()}, {"name", "lamp \"\n" + text()}};
        if (type != 2) light["position"] = list(vector(-1e6, 1e6));
        if (type == 2 && coin()) {
            light["sun"] = {{"latitude", number(-90, 90)},
                            {"longitude", number(-180, 180)},
                            {"time", "2031-05-0" + std::to_string(1 + below(9)) + "T07:08:09-03:30"},
                            {"north", number(-360, 360)}};
        } else if (type != 1) {
            light["direction"] = list(vector(1, 2));
        }
        if (type == 0) light["angle"] = number(.1, 170), light["softness"] = number(0, 1);
        if (type == 2) light["angular_radius"] = number(0, 90);
        if (type == 3)
            light["width"] = number(.1, 9), light["height"] = number(.1, 9), light["up"] = list(vector(0, 1));
        if (type == 4) light["radius"] = number(1e-6, 1e9);
        light[type < 2 ? "intensity" : type == 2 ? "irradiance" : "radiance"] = list(vector(0, 1e12));
        return light;
    }
    nlohmann::json material() {
        nlohmann::json material = {{"name", text()},
                                   {"on", coin()},
                                   {"diffuse", list(vector(0, 10))},
                                   {"specular", number(0, 1)},
                                   {"shininess", number(0, 1e6)},
                                   {"emission", list(vector(0, 9))},
                                   {"class", below(256)}};
        if (coin()) material["scan"] = below(65536);
        if (coin()) material["box"] = {{"min", list(vector(-9, 0))}, {"max", list(vector(0, 9))}};
        return material;
    }
    nlohmann::json look() {
        nlohmann::json look = {{"colour", "elevation"}, {"reversed", coin()}, {"axes", coin()}};
        look["point_size"] = number(.05, 20);
        look["range"] = {{"low", number(-1e300, 1e300)}, {"high", number(0, 1)}};
        look["clip"]["boxes"] = {
            {{"min", list(vector(-9, 0))}, {"max", list(vector(0, 9))}, {"rotation", number(-360, 360)}}};
        look["clip"]["planes"] = {{{"position", list(vector(-9, 0))}, {"normal", list(vector(1, 9))}}};
        look["backdrop"] = {{"top", list(vector(0, 1))}};
        if (coin()) look["hidden_classes"] = {below(256)};
        if (coin()) look["outliers"] = below(4);
        return look;
    }
    nlohmann::json scene() {
        nlohmann::json scene = nlohmann::json::object();
        if (coin()) scene["lighting_region"] = {{"min", list(vector(-9, 0))}, {"max", list(vector(0, 9))}};
        for (size_t i = below(5); i > 0; --i) scene["lights"].push_back(light());
        for (size_t i = below(4); i > 0; --i) scene["materials"].push_back(material());
        if (coin()) scene["materials"].push_back({{"diffuse", list(vector(0, 1))}});
        for (size_t i = below(4); i > 0; --i)
            scene["cameras"].push_back({{"name", std::to_string(i)},
                                        {"position", list(vector(-9, 0))},
                                        {"target", list(vector(1, 9))},
                                        {"fov", number(1, 170)}});
        if (coin()) scene["exposure"] = {{"ev", number(-40, 40)}};
        if (coin()) scene["exposure"]["tone_map"] = tone_map_names()[below(4)];
        if (coin()) scene["exposure"]["white"] = {number(.001, 1000), number(.1, 10), 1};
        if (coin()) scene["exposure"]["luminance"] = {{"low", number(1e-9, 1)}, {"high", number(2, 1e15)}};
        if (coin())
            scene["background"] = list(vector(0, 9));
        else
            scene["environment"] = {
                {"on", coin()}, {"radiance", list(vector(0, 9))}, {"rotation", number(-360, 360)}};
        if (coin())
            scene["albedo"] = {{"scale", number(0, 10)},
                               {"flatten", number(0, 1)},
                               {"balance", coin()},
                               {"white", {number(.5, 2), 1, number(.5, 2)}}};
        if (coin()) scene["look"] = look();
        if (coin())
            scene["comparison"] = {{"engine", "direct"},
                                   {"show", comparison_names()[below(3)]},
                                   {"border", number(0, 1)},
                                   {"range", number(1e-6, 9)}};
        if (coin()) scene["render"] = render();
        return scene;
    }
    nlohmann::json render() {
        nlohmann::json render = {{"engine", "vpl"}, {"preset", "high"}};
        if (coin()) render["bounces"] = below(65);
        if (coin()) render["only_bounce"] = below(65);
        if (coin()) render["vpls"] = 1 + below(65536);
        if (coin()) render["interleave"] = 1 << below(3);
        if (coin()) render["atlas"] = 256 << below(6);
        if (coin()) render["light_resolution"] = 64 << below(7);
        if (coin()) render["samples"] = 1 + below(1 << 20);
        if (coin()) render["scale"] = number(.25, 1);
        return render;
    }

 private:
    static nlohmann::json list(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
    std::string text() { return coin() ? "" : "n\u00e4me " + std::to_string(below(100)); }
    std::mt19937 random_;
};

TEST(SceneWriter, ScenesByChanceComeBackTheSame) {
    for (uint32_t seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        const std::string text = Chance(seed).scene().dump();
        const auto scene = parse_scene(text, "chance.json");
        ASSERT_TRUE(scene) << scene.error().line() << '\n' << text;
        expect_round_trip(*scene, ".");
        if (HasFailure()) return;
    }
}

TEST(SceneWriter, AnEmptySceneWritesNothing) {
    EXPECT_EQ(write_scene(*parse_scene("{}", "empty.json")), "{}\n");
}

TEST(SceneWriter, PicturesAreNamedAsSeenFromTheFile) {
    const test::Folder files;
    const auto& folder = files.path();
    std::filesystem::create_directories(folder / "skies");
    std::filesystem::create_directories(folder / "scenes");
    ASSERT_TRUE(io::write_exr(folder / "skies/blue.exr", {2, 1, {{1, 2, 3, 1}, {4, 5, 6, 1}}}, true));
    const auto scene = parse_scene(
        R"({"environment": {"image": "skies/blue.exr", "radiance": [2, 2, 2], "rotation": 33.3}})",
        "sky.json", folder);
    ASSERT_TRUE(scene) << scene.error().line();
    const auto path = folder / "scenes/saved.json";
    ASSERT_TRUE(save_scene(*scene, path, true));
    EXPECT_THAT(load_text(path).value(), testing::HasSubstr("../skies/blue.exr"));
    const auto again = load_scene(path);
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_EQ(again->environment->texels, scene->environment->texels);
    EXPECT_EQ(again->environment->rotation, scene->environment->rotation);
}

TEST(SceneWriter, AnExistingFileIsKeptUnlessItMayBeReplaced) {
    const test::Folder folder;
    const auto path = folder / "scene.json";
    ASSERT_TRUE(save_scene({}, path, true));
    EXPECT_FALSE(save_scene({}, path, false));
}

}  // namespace
}  // namespace lucarne::gi
