#include "io/files/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucarne {
namespace {

using testing::HasSubstr;

/// Returns the line that a user sees when `read` reads a text.
template <class Read>
std::string complaint(std::string_view text, const Read& read) {
    const auto document = parse_json(text, "file.json");
    if (!document) return document.error().line();
    auto object = JsonObject::of(*document, "file.json");
    if (!object) return object.error().line();
    const Result<void> result = read(*object);
    return result ? "" : result.error().line();
}

TEST(Json, ASyntaxErrorNamesItsLineAndColumn) {
    const auto parsed = parse_json("{\n  \"a\": 1,\n  \"b\" 2\n}", "file.json");
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().kind, ErrorKind::input_rejected);
    EXPECT_THAT(parsed.error().line(), HasSubstr("file.json: line 3, column 7: "));
    for (const std::string_view bad : {"", "{", "[1,", "{\"a\":1e999}", "\xff\xfe", "nul"})
        EXPECT_FALSE(parse_json(bad, "f")) << bad;
}

TEST(Json, ASyntaxErrorIsOneShortLineInOurWords) {
    const std::string digits(5000, '9');
    const std::pair<std::string, std::string> cases[] = {
        {"{\n  \"a\": 1e999\n}",
         "f: line 2, column 8: the number 1e999 is too large; correct the JSON there"},
        {"{\n  \"a\": -" + digits + "e9\n}", "line 2, column 8: the number -99"},
        {"{\"a\": 1", "line 1, column 8: the text ends early"},
        {"", "line 1, column 1: the text ends early"},
        {"{\"a\" 2}", "line 1, column 6: ':' is expected, not "},
        {"[\"" + digits + "\n\"]", "line 1"},
        {"{" + digits + "}", "is expected, not "},
        {"[\x1b[2J]", "line 1, column 2: "},
    };
    for (const auto& [text, line] : cases) {
        const auto parsed = parse_json(text, "f");
        ASSERT_FALSE(parsed) << text;
        EXPECT_THAT(parsed.error().line(), HasSubstr(line));
        EXPECT_THAT(parsed.error().line(), testing::Not(HasSubstr("json.exception")));
        EXPECT_LT(parsed.error().line().size(), 200u);
    }
}

TEST(Json, DeeplyNestedTextIsNoDanger) {
    const std::string deep(2000000, '[');
    EXPECT_FALSE(parse_json(deep, "f"));
}

TEST(Json, MistakesNameTheirPointer) {
    const auto read = [](JsonObject& object) -> Result<void> {
        LUCARNE_ASSIGN(auto lights, object.objects("lights", 3));
        for (JsonObject& light : lights) {
            LUCARNE_TRY(light.number("angle", {1, 179}));
            LUCARNE_TRY(light.vector("position"));
            LUCARNE_TRY(light.integer("id", 0, 255, 0));
            LUCARNE_TRY(light.choice("kind", {"spot", "sun"}, 0));
            LUCARNE_TRY(light.boolean("on", true));
            LUCARNE_TRY(light.text("name", ""));
            LUCARNE_TRY(light.finish());
        }
        return object.finish();
    };
    EXPECT_EQ(complaint(R"({"lights": [{"angle": 30, "position": [0, 1, 2.5]}]})", read), "");
    const std::pair<const char*, const char*> cases[] = {
        {R"([])", "the whole document: must be an object"},
        {R"({"lights": 1})", "/lights: must be an array"},
        {R"({"lights": [1]})", "/lights/0: must be an object"},
        {R"({"lights": [{}, {}, {}, {}]})", "/lights: must be an array of at most 3"},
        {R"({"lights": [{"position": [0, 0, 0]}]})", "/lights/0: the key 'angle' is missing"},
        {R"({"lights": [{"angle": "30"}]})", "/lights/0/angle: must be a number from 1 to 179, not \"30\""},
        {R"({"lights": [{"angle": 180}]})", "/lights/0/angle: must be a number"},
        {R"({"lights": [{"angle": 30, "position": [0, 1]}]})", "/lights/0/position: must be three numbers"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, null]}]})", "/lights/0/position: must be three"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "id": 256}]})",
         "/lights/0/id: must be an integer"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "id": 18446744073709551615}]})",
         "/lights/0/id:"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "id": 1.5}]})",
         "/lights/0/id: must be an integer"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "kind": "x"}]})",
         "/lights/0/kind: must be one of spot, sun"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "on": 1}]})",
         "/lights/0/on: must be true or false"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "name": 1}]})",
         "/lights/0/name: must be a text"},
        {R"({"lights": [{"angle": 30, "position": [0, 1, 2], "a/b~": 1}]})",
         "/lights/0/a~1b~0: is not a known key"},
        {R"({"light": []})", "/light: is not a known key; known here are: lights"},
    };
    for (const auto& [text, expected] : cases)
        EXPECT_THAT(complaint(text, read), HasSubstr(expected)) << text;
}

TEST(Json, ObjectsWithinObjectsKeepTheirPlace) {
    const auto read = [](JsonObject& object) -> Result<void> {
        LUCARNE_ASSIGN(auto inner, object.object("inner"));
        if (inner) LUCARNE_TRY(inner->finish());
        return object.finish();
    };
    EXPECT_EQ(complaint("{}", read), "");
    EXPECT_EQ(complaint(R"({"inner": {}})", read), "");
    EXPECT_THAT(complaint(R"({"inner": {"x": 1}})", read), HasSubstr("/inner/x: is not a known key"));
    EXPECT_THAT(complaint(R"({"inner": 3})", read), HasSubstr("/inner: must be an object"));
}

}  // namespace
}  // namespace lucarne
