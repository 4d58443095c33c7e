// Lost contexts, and shader files that change while the program runs.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "gi/device/gl/context_watch.h"
#include "tests/gi/on_device.h"
#include "tests/temporary_folder.h"

namespace lucarne::gi {
namespace {

using testing::HasSubstr;

struct ContextLoss : OnDevice {};

TEST_F(ContextLoss, AContextThatWorksIsNotTakenForALostOne) {
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(device->check());
}

TEST_F(ContextLoss, AnInjectedLossStaysAndSaysWhy) {
    lost_on_purpose = true;
    device->lose_after(3);
    EXPECT_TRUE(device->check());
    EXPECT_TRUE(device->check());
    const auto lost = device->check();
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().what, "graphics device");
    EXPECT_NE(lost.error().why, "");
    EXPECT_FALSE(device->check()) << "what is lost does not come back";
}

TEST(LossPlan, GivesTheNumbersOfAListOneAContextAndThenNone) {
    LossPlan plan("30,5");
    EXPECT_EQ(plan.next(), 30u);
    EXPECT_EQ(plan.next(), 5u);
    EXPECT_EQ(plan.next(), std::nullopt);
    EXPECT_EQ(LossPlan("").next(), std::nullopt);
    EXPECT_EQ(LossPlan("soon").next(), std::nullopt);
    EXPECT_EQ(LossPlan("99999999999").next(), std::nullopt) << "no number that there is";
}

/// A shader folder with one file.
class ShaderFiles : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        std::filesystem::create_directories(folder_ / "gi/post");
    }
    /// Writes a shader that runs `statement` in eight invocations, with a buffer of words at binding 0.
    void write(const std::string& statement) const {
        std::ofstream(folder_ / kPath) << "layout(local_size_x = 8) in;\n"
                                          "layout(std430, binding = 0) buffer Words { uint words[]; };\n"
                                          "void main() {\n"
                                       << statement << "\n}\n";
    }
    uint32_t result() {
        auto buffer = device->buffer(32, "words");
        const auto program = device->program(kPath);
        EXPECT_TRUE(program) << program.error().line();
        if (!buffer || !program) return 0;
        buffer->clear(0);
        buffer->bind(0);
        (*program)->dispatch(8);
        return buffer->download_all<uint32_t>(8)[7];
    }

    static constexpr const char* kPath = "gi/post/luminance.comp";
    test::Folder files_;
    const std::filesystem::path& folder_ = files_.path();
};

TEST_F(ShaderFiles, AreUsedInPlaceOfTheProgramsOwnAndReadAgainOnDemand) {
    write("words[gl_GlobalInvocationID.x] = 7u;");
    device->use_shader_folder(folder_);
    EXPECT_EQ(result(), 7u);
    write("words[gl_GlobalInvocationID.x] = 8u;");
    EXPECT_EQ(result(), 7u) << "nobody asked to read it again";
    device->reload_shaders();
    EXPECT_EQ(result(), 8u);
    EXPECT_EQ(device->shader_problem(), "");
    EXPECT_TRUE(device->program("gi/post/tone_map.comp")) << "what is not in the folder is the program's own";
}

TEST_F(ShaderFiles, ABrokenOneIsNamedWithItsLineAndTheLastGoodProgramStays) {
    write("words[gl_GlobalInvocationID.x] = 7u;");
    device->use_shader_folder(folder_);
    EXPECT_EQ(result(), 7u);
    write("words[gl_GlobalInvocationID.x] = seven;");
    device->reload_shaders();
    EXPECT_EQ(result(), 7u);
    EXPECT_THAT(device->shader_problem(), HasSubstr("gi/post/luminance.comp:4"));
    std::filesystem::remove(folder_ / kPath);
    write("words[gl_GlobalInvocationID.x] = 9u;");
    device->reload_shaders();
    EXPECT_EQ(result(), 9u);
    EXPECT_EQ(device->shader_problem(), "") << "it is mended";
}

TEST_F(ShaderFiles, OneThatIsBrokenFromTheStartLeavesTheProgramsOwn) {
    write("words[gl_GlobalInvocationID.x] = seven;");
    device->use_shader_folder(folder_);
    const auto program = device->program(kPath);
    EXPECT_TRUE(program);
    EXPECT_THAT(device->shader_problem(), HasSubstr("gi/post/luminance.comp:4"));
}

}  // namespace
}  // namespace lucarne::gi
