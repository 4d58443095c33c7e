// OpenCL beside OpenGL: the surfels of a frame are copied there and give the same sums.
#include "gi/device/cl/cl_device.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/device/exchange/exchange.h"
#include "gi/registry.h"
#include "gi/surfels/flat_surfels.h"
#include "tests/gi/device/cl/on_opencl.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSum = R"(#include "gi/shared/flat_surfel.h"
// Sums `run` surfels per item, in order.
kernel void sum(global const FlatSurfel* surfels, uint count, uint run, global float* areas) {
    uint part = get_global_id(0);
    uint first = part * run;
    if (first >= count) return;
    float area = 0;
    for (uint i = first; i < min(first + run, count); ++i) area += surfels[i].area;
    areas[part] = area;
}
)";

/// The embedded texts and one more.
std::vector<ShaderText> texts_with(const char* text) {
    std::vector<ShaderText> texts = shader_texts();
    texts.push_back({"test.cl", text});
    return texts;
}

using ClDeviceTest = OnOpenCl;

TEST_F(ClDeviceTest, SaysWhatItIs) {
    EXPECT_FALSE(opencl->info().name.empty());
    EXPECT_GT(opencl->info().units, 0u);
    EXPECT_GT(opencl->info().max_buffer_bytes, uint64_t{1} << 20);
}

TEST_F(ClDeviceTest, SumsTheSurfelsOfAFrameToTheValueOfTheHost) {
    const SurfelCloud cloud(scenes::closed_box(4, 100, glm::vec3(.5f)));
    const auto scene = load_cloud(*device, cloud);
    ASSERT_TRUE(scene) << scene.error().line();
    const DeviceCut& cut = (*scene)->cut;
    const size_t count = flat_count(cut);
    Buffer flat;
    ASSERT_TRUE(flatten(*device, cut, flat));
    ClBuffer surfels, areas;
    const auto copied = copy_to_cl(flat, count * sizeof(FlatSurfel), *opencl, surfels, "flat surfels");
    ASSERT_TRUE(copied) << copied.error().line();

    constexpr uint32_t kRun = 100;
    const uint32_t parts = (static_cast<uint32_t>(count) + kRun - 1) / kRun;
    ASSERT_TRUE(opencl->reserve(areas, parts * sizeof(float), "sums"));
    const auto kernel = opencl->kernel("test.cl", "sum", {}, texts_with(kSum));
    ASSERT_TRUE(kernel) << kernel.error().line();
    const auto ran = (*kernel)->run(parts, 64, surfels, static_cast<uint32_t>(count), kRun, areas);
    ASSERT_TRUE(ran) << ran.error().line();
    EXPECT_TRUE(opencl->finish());
    std::vector<float> sums(parts);
    ASSERT_TRUE(areas.download(0, std::as_writable_bytes(std::span(sums))));

    const auto on_host = flat.download_all<FlatSurfel>(count);
    EXPECT_TRUE(std::ranges::all_of(on_host, [](const FlatSurfel& s) { return s.edges == kNoEdges; }));
    double all = 0;
    for (uint32_t part = 0; part < parts; ++part) {
        float expected = 0;
        for (size_t i = size_t{part} * kRun; i < std::min<size_t>(count, (size_t{part} + 1) * kRun); ++i)
            expected += on_host[i].area;
        ASSERT_EQ(sums[part], expected) << part;
        all += expected;
    }
    // Both sums are the surface: six faces of 4 m by 4 m, as the pool itself decodes it.
    const auto decoded = (*scene)->pool.download(cut);
    const double truth =
        std::accumulate(decoded.begin(), decoded.end(), 0.0,
                        [](double sum, const Surfel& surfel) { return sum + double(surfel.area); });
    EXPECT_NEAR(all, truth, 1e-4 * truth);
    EXPECT_NEAR(all, 96, 8);
}

TEST_F(ClDeviceTest, BuffersGoThereAndBackUnchanged) {
    auto there = device->buffer(1 << 20, "words");
    ASSERT_TRUE(there);
    std::vector<uint32_t> words(1 << 18);
    std::iota(words.begin(), words.end(), 7u);
    there->upload_all(words);
    ClBuffer between;
    Buffer back;
    ASSERT_TRUE(copy_to_cl(*there, 1 << 20, *opencl, between, "words"));
    ASSERT_TRUE(copy_to_gl(between, 1 << 20, *device, back, "words"));
    EXPECT_EQ(back.download_all<uint32_t>(words.size()), words);
}

TEST_F(ClDeviceTest, ErrorsOfKernelsNameFileAndLine) {
    const auto broken = opencl->kernel(
        "test.cl", "sum", {},
        texts_with("#include \"gi/shared/flat_surfel.h\"\n\nkernel void sum() {\n  none();\n}\n"));
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().why, HasSubstr("test.cl:4:"));
    const auto missing = opencl->kernel("test.cl", "none", {}, texts_with(kSum));
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().what, "kernel none of test.cl");
    EXPECT_FALSE(opencl->kernel("nowhere.cl", "sum"));
}

TEST_F(ClDeviceTest, MemoryCountsUnderTheCapOfBoth) {
    const uint64_t before = device->memory_used();
    device->set_memory_cap(before + (uint64_t{3} << 20));
    {
        auto first = opencl->buffer(2 << 20, "first");
        ASSERT_TRUE(first);
        EXPECT_EQ(device->memory_used(), before + (2u << 20));
        const auto second = opencl->buffer(2 << 20, "second");
        ASSERT_FALSE(second);
        EXPECT_EQ(second.error().what, "second");
        EXPECT_FALSE(device->buffer(2 << 20, "third")) << "OpenGL has no more either";
        std::vector<std::byte> bytes((2 << 20) + 1);
        EXPECT_FALSE(first->upload(0, bytes));
        EXPECT_FALSE(first->download(1, std::span(bytes).first(2 << 20)));
    }
    EXPECT_EQ(device->memory_used(), before);
}

constexpr const char* kNumber =
    "kernel void number(global uint* words, uint from) { words[get_global_id(0)] = from + get_global_id(0); "
    "}\n";

struct OpenClLoss : ClDeviceTest {
    /// Returns the last of 64 words that a kernel numbers from 7 on.
    Result<uint32_t> last_word() {
        LUCARNE_ASSIGN(ClBuffer words, opencl->buffer(256, "words"));
        LUCARNE_ASSIGN(const ClKernel* kernel, opencl->kernel("test.cl", "number", {}, texts_with(kNumber)));
        LUCARNE_TRY(kernel->run(64, 0, words, 7u));
        std::vector<uint32_t> numbers(64);
        LUCARNE_TRY(words.download(0, std::as_writable_bytes(std::span(numbers))));
        return numbers.back();
    }
};

TEST_F(OpenClLoss, StaysAndTheOpenGlDeviceReportsIt) {
    lost_on_purpose = true;
    ASSERT_EQ(last_word().value_or(0), 70u);
    opencl->lose_after(4);
    EXPECT_EQ(last_word().value_or(0), 70u) << "run and download";
    EXPECT_TRUE(device->check());
    const auto lost = last_word();
    ASSERT_FALSE(lost);
    EXPECT_THAT(lost.error().line(), HasSubstr("was lost"));
    const auto reported = device->check();
    ASSERT_FALSE(reported);
    EXPECT_EQ(reported.error().what, "graphics device");
    EXPECT_THAT(reported.error().why, HasSubstr("OpenCL: the device " + opencl->info().name + " was lost"));
    EXPECT_FALSE(opencl->finish()) << "what is lost does not come back";
    EXPECT_FALSE(opencl->buffer(16, "words"));
    EXPECT_FALSE(opencl->kernel("test.cl", "number", {}, texts_with(kNumber)));
    EXPECT_FALSE(device->check());

    opencl.reset();
    OnDevice::SetUp();
    lost_on_purpose = false;
    auto opened = ClDevice::open(*device);
    ASSERT_TRUE(opened) << opened.error().line();
    opencl = std::move(*opened);
    EXPECT_EQ(last_word().value_or(0), 70u);
}

TEST_F(OpenClLoss, OtherErrorsAreNotTakenForOne) {
    auto words = opencl->buffer(256, "words");
    const auto kernel = opencl->kernel("test.cl", "number", {}, texts_with(kNumber));
    ASSERT_TRUE(words && kernel);
    EXPECT_FALSE((*kernel)->run(1, size_t{1} << 30, *words, 7u)) << "no device has groups of this size";
    EXPECT_FALSE(opencl->kernel("test.cl", "none", {}, texts_with(kNumber)));
    EXPECT_EQ(last_word().value_or(0), 70u);
    EXPECT_TRUE(device->check());
}

/// OpenGL draws the same before and after OpenCL has started in the same process: both use LLVM on
/// processors.
using OpenClBesideOpenGl = OnDevice;
TEST_F(OpenClBesideOpenGl, ChangesNoPicture) {
    const SurfelCloud cloud(scenes::closed_box(4, 60, glm::vec3(.5f)));
    const CameraView camera = look({2, 1, 2}, {2, 4, 2}, 48, 48);
    LitOptions options;
    options.lights = {make_spot({2, 1, 2}, {2, 4, 2}, 0.6f, 10)};
    const auto picture = [&] {
        return light_up(*device, **make_engine("direct"), cloud, camera, options).radiance;
    };
    const auto before = picture();
    auto opened = ClDevice::open(*device);
    ASSERT_TRUE(opened) << opened.error().line();
    ASSERT_TRUE((*opened)->kernel("test.cl", "sum", {}, texts_with(kSum)));
    EXPECT_TRUE(picture() == before);
}

}  // namespace
}  // namespace lucarne::gi
