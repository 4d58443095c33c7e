#include "gi/device/gl/device.h"

#include <chrono>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "gi/device/common/shader_source.h"
#include "gi/device/gl/pass_times.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using DeviceTest = OnDevice;

TEST_F(DeviceTest, HeadlessContextOffersWhatTheShadersNeed) {
    EXPECT_FALSE(device->info().renderer.empty());
    EXPECT_GE(device->info().max_buffer_bytes, uint64_t{1} << 27);
}

TEST_F(DeviceTest, DriverIsTheOneThatTheRunAskedFor) {
    const char* renderer = std::getenv("LUCARNE_TEST_RENDERER");
    if (!renderer) GTEST_SKIP() << "LUCARNE_TEST_RENDERER names no driver";
    EXPECT_NE(device->info().renderer.find(renderer), std::string::npos) << device->info().renderer;
}

TEST_F(DeviceTest, BufferReturnsWhatWasUploaded) {
    std::vector<uint32_t> words(1000);
    std::iota(words.begin(), words.end(), 7u);
    auto buffer = device->buffer(words.size() * 4, "words");
    ASSERT_TRUE(buffer);
    buffer->upload_all(words);
    EXPECT_EQ(buffer->download_all<uint32_t>(words.size()), words);
    buffer->clear(0xdeadbeefu);
    EXPECT_EQ(buffer->download_all<uint32_t>(words.size()), std::vector<uint32_t>(words.size(), 0xdeadbeefu));
}

TEST_F(DeviceTest, MemoryCapIsKeptAndFreedMemoryCountsNoMore) {
    device->set_memory_cap(1 << 20);
    auto first = device->buffer(700 << 10, "first");
    ASSERT_TRUE(first);
    const auto second = device->buffer(700 << 10, "second");
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().what, "second");
    EXPECT_EQ(device->memory_used(), first->bytes());
    *first = Buffer();
    EXPECT_EQ(device->memory_used(), 0u);
    EXPECT_TRUE(device->buffer(700 << 10, "third"));
}

TEST_F(DeviceTest, ReserveGrowsWithoutHoldingBothAtOnce) {
    device->set_memory_cap(1 << 20);
    Buffer buffer;
    ASSERT_TRUE(device->reserve(buffer, 600 << 10, "buffer"));
    const uint32_t id = buffer.id();
    ASSERT_TRUE(device->reserve(buffer, 1000, "buffer"));
    EXPECT_EQ(buffer.id(), id) << "what is large enough stays";
    ASSERT_TRUE(device->reserve(buffer, 900 << 10, "buffer"));
    EXPECT_FALSE(device->reserve(buffer, 2 << 20, "buffer"));
}

TEST_F(DeviceTest, BufferBeyondTheDevicesLimitIsAnError) {
    const auto buffer = device->buffer(device->info().max_buffer_bytes + 1, "surfels");
    ASSERT_FALSE(buffer);
    EXPECT_EQ(buffer.error().kind, ErrorKind::failed);
}

TEST_F(DeviceTest, AccessBeyondTheEndOfABufferIsRefused) {
    auto buffer = device->buffer(64, "words");
    ASSERT_TRUE(buffer);
    std::vector<std::byte> bytes(65);
    EXPECT_THROW(buffer->upload(0, bytes), std::logic_error);
    EXPECT_THROW(buffer->download(SIZE_MAX, bytes), std::logic_error);
}

TEST_F(DeviceTest, UnknownShaderIsAnError) {
    const auto program = device->program("gi/none.comp");
    ASSERT_FALSE(program);
    EXPECT_EQ(program.error().what, "shader gi/none.comp");
}

TEST_F(DeviceTest, ShaderThatDoesNotCompileIsAnErrorThatNamesItsFile) {
    const auto program = device->program("gi/raster/resolve.comp", {{"uint", "unsigned"}});
    ASSERT_FALSE(program);
    EXPECT_EQ(program.error().what, "shader gi/raster/resolve.comp");
    EXPECT_NE(program.error().why.find("gi/"), std::string::npos) << program.error().why;
    EXPECT_TRUE(device->program("gi/raster/resolve.comp"))
        << "the same file without the define is another program";
}

TEST_F(DeviceTest, UniformThatNoShaderDeclaresIsAnError) {
    const auto program = device->program("gi/post/luminance.comp");
    ASSERT_TRUE(program);
    (*program)->set("pixels", 1u);
    EXPECT_TRUE(device->check());
    (*program)->set("pixel", 1u);
    const auto checked = device->check();
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().what, "shader gi/post/luminance.comp: uniform pixel");
    EXPECT_TRUE(device->check()) << "it is said once";
}

/// The host sleeps in the first pass, the device works in the second.
TEST_F(DeviceTest, PassesAreTimedInOrderByEitherClockWhetherHostOrDeviceWorks) {
    for (const PassTimes::Clock clock : {PassTimes::Clock::wall, PassTimes::Clock::queries}) {
        PassTimes times(*device, clock);
        auto buffer = device->buffer(size_t{64} << 20, "test");
        ASSERT_TRUE(buffer);
        for (int frame = 0; frame < 3; ++frame) {
            times.clear();
            times.begin("host");
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            times.end();
            times.begin("device");
            buffer->clear(1);
            times.end();
            times.finish();
            ASSERT_EQ(times.passes().size(), 2u);
            EXPECT_EQ(times.passes()[0].name, "host");
            EXPECT_EQ(times.passes()[1].name, "device");
            EXPECT_GE(times.passes()[0].seconds, 0.02);
            EXPECT_GT(times.passes()[1].seconds, 0.0);
        }
    }
}

TEST(DeviceDeathTest, MachineWithoutADriverGetsOneClearLine) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto without_driver = [] {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json", 1);
        const auto device = Device::headless();
        if (!device) std::fprintf(stderr, "%s\n", device.error().line().c_str());
        std::exit(device ? 0 : static_cast<int>(device.error().kind));
    };
    EXPECT_EXIT(without_driver(), ::testing::ExitedWithCode(1), "OpenGL: no usable device: .*; install ");
}

TEST(ShaderSource, FileIsIncludedOnceAndBracketsAreDropped) {
    const std::vector<ShaderText> texts = {
        {"a.comp", "#include \"b.glsl\"\n  #include <cstdint>\n#include \"b.glsl\"\nvoid main() {}\n"},
        {"b.glsl", "#include \"a.comp\"\nint b;"}};
    const auto source = shader_source("a.comp", {{"N", "4"}}, texts);
    ASSERT_TRUE(source);
    EXPECT_EQ(source->files, (std::vector<std::string>{"a.comp", "b.glsl"}));
    EXPECT_EQ(
        source->text,
        "#version 450 core\n#define N 4\n#line 1 0\n#line 1 1\n#line 2 1\nint b;\n#line 2 0\n#line 3 0\n"
        "#line 4 0\nvoid main() {}\n");
}

TEST(ShaderSource, UniformsAreFoundByTheirDeclarations) {
    EXPECT_EQ(declared_uniforms(
                  "uniform uint pixels;  // uniform uint no;\nuniform vec4 ramp[RAMP], other;\n"
                  "layout(binding = 3) uniform usamplerBuffer texels;\nfloat uniformity; uniform CameraView\n"
                  "    camera;\nvoid main() { nonuniform(x); }"),
              (std::set<std::string, std::less<>>{"camera", "other", "pixels", "ramp", "texels"}));
}

TEST(ShaderSource, MissingIncludeIsAnError) {
    const auto source = shader_source("a.comp", {}, {{"a.comp", "#include \"nowhere.glsl\"\n"}});
    ASSERT_FALSE(source);
    EXPECT_EQ(source.error().what, "shader nowhere.glsl");
}

TEST(ShaderSource, CompilersMessagesNameTheFile) {
    const std::vector<std::string> files = {"a.comp", "b.glsl"};
    EXPECT_EQ(readable_message("1:23(4): error: no such function\n0:1(1): error: x", files),
              "b.glsl:23: error: no such function");
    EXPECT_EQ(readable_message("0(7) : error C0000: syntax error", files),
              "a.comp:7: error C0000: syntax error");
    EXPECT_EQ(readable_message("linking failed", files), "linking failed");
}

}  // namespace
}  // namespace lucarne::gi
