// OpenCL beside OpenGL: the surfels of a frame are copied there and give the same sums.
#include "gi/device/cl/cl_device.h"

#include <algorithm>
#include <cmath>
#include <memory>
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

using ClDeviceTest = OnOpenCl;

TEST_F(ClDeviceTest, SaysWhatItIs) {
    EXPECT_FALSE(opencl->info().name.empty());
    EXPECT_GT(opencl->info().units, 0u);
    EXPECT_GT(opencl->info().max_buffer_bytes, uint64_t{1} << 20);
    EXPECT_GE(opencl->info().local_memory, 32u << 10) << "what OpenCL's full profile demands";
    EXPECT_GE(opencl->info().max_group_size, 1u);
}

TEST_F(ClDeviceTest, IsOneForAllEnginesOfAnOpenGlDevice) {
    const auto again = device->opencl();
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, opencl);
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
    device->add_shader("sum.cl", kSum);
    const auto kernel = opencl->kernel("sum.cl", "sum");
    ASSERT_TRUE(kernel) << kernel.error().line();
    const auto ran = (*kernel)->run(ClRange(parts, 64), surfels, static_cast<uint32_t>(count), kRun, areas);
    ASSERT_TRUE(ran) << ran.error().line();
    EXPECT_TRUE(opencl->finish());
    std::vector<float> sums(parts);
    ASSERT_TRUE(areas.download(0, std::as_writable_bytes(std::span(sums))));

    const auto on_host = flat.download_all<FlatSurfel>(count);
    EXPECT_TRUE(std::ranges::all_of(on_host, [](const FlatSurfel& s) { return s.edge_root == 0; }));
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

TEST_F(ClDeviceTest, KeepsWhatIsLentAsLongAsTheBufferIsInUse) {
    const auto data = std::make_shared<const std::vector<uint32_t>>(std::vector<uint32_t>{1, 2, 3, 4, 5});
    const std::weak_ptr<const void> kept = data;
    const auto bytes = std::as_bytes(std::span(*data));
    const uint64_t before = device->memory_used();
    {
        ClBuffer lent;
        const auto sent = opencl->lend(lent, bytes, data, "numbers");
        ASSERT_TRUE(sent) << sent.error().line();
        EXPECT_EQ(kept.use_count(), opencl->info().is_gpu ? 1 : 2);
        EXPECT_EQ(device->memory_used(), before + bytes.size());
        std::vector<uint32_t> back(data->size());
        ASSERT_TRUE(lent.download(0, std::as_writable_bytes(std::span(back))));
        EXPECT_EQ(back, *data);
        ClBuffer moved = std::move(lent);
        EXPECT_EQ(kept.use_count(), opencl->info().is_gpu ? 1 : 2);
        EXPECT_FALSE(opencl->lend(moved, {}, data, "nothing"));
    }
    EXPECT_EQ(kept.use_count(), 1);
    EXPECT_EQ(device->memory_used(), before);
}

TEST_F(ClDeviceTest, ErrorsOfKernelsNameFileAndLine) {
    device->add_shader("sum.cl",
                       "#include \"gi/shared/flat_surfel.h\"\n\nkernel void sum() {\n  none();\n}\n");
    const auto broken = opencl->kernel("sum.cl", "sum");
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().why, HasSubstr("sum.cl:4:"));
    device->add_shader("sum.cl", kSum);
    const auto missing = opencl->kernel("sum.cl", "none");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().what, "kernel none of sum.cl");
    EXPECT_TRUE(opencl->kernel("sum.cl", "sum"));
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
    "}\n"
    "kernel __attribute__((reqd_work_group_size(8, 1, 1))) void eights(global uint* words) {}\n";

struct OpenClLoss : ClDeviceTest {
    void SetUp() override {
        ClDeviceTest::SetUp();
        if (device) device->add_shader("number.cl", kNumber);
    }
    /// Returns the last of 64 words that a kernel numbers from 7 on.
    Result<uint32_t> last_word() {
        LUCARNE_ASSIGN(ClBuffer words, opencl->buffer(256, "words"));
        LUCARNE_ASSIGN(const ClKernel* kernel, opencl->kernel("number.cl", "number"));
        LUCARNE_TRY(kernel->run(ClRange(64), words, 7u));
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
    EXPECT_FALSE(opencl->kernel("number.cl", "number"));
    EXPECT_FALSE(device->check());

    SetUp();  // makes both devices again
    lost_on_purpose = false;
    EXPECT_EQ(last_word().value_or(0), 70u);
}

TEST_F(OpenClLoss, IsNoticedWhileTheOpenGlDeviceFinishesAFrame) {
    lost_on_purpose = true;
    auto words = opencl->buffer(256, "words");
    const auto kernel = opencl->kernel("number.cl", "number");
    ASSERT_TRUE(words && kernel);
    opencl->lose_after(2);
    ASSERT_TRUE((*kernel)->run(ClRange(64), *words, 7u));
    EXPECT_TRUE(device->check());
    device->finish();
    EXPECT_FALSE(device->check());
}

TEST_F(OpenClLoss, OtherErrorsAreNotTakenForOne) {
    auto words = opencl->buffer(256, "words");
    const auto kernel = opencl->kernel("number.cl", "eights");
    ASSERT_TRUE(words && kernel);
    EXPECT_FALSE((*kernel)->run(ClRange(4, 4), *words)) << "its groups have 8 work-items";
    EXPECT_FALSE(opencl->kernel("number.cl", "none"));
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
    options.lights = {scenes::spot({2, 1, 2}, {2, 4, 2}, 0.6f, 0.6f, 10)};
    const auto picture = [&] {
        return light_up(*device, **make_engine("direct"), cloud, camera, options).radiance;
    };
    const auto before = picture();
    device->add_shader("sum.cl", kSum);
    const auto opened = device->opencl();
    ASSERT_TRUE(opened) << opened.error().line();
    ASSERT_TRUE((*opened)->kernel("sum.cl", "sum"));
    EXPECT_TRUE(picture() == before);
}

}  // namespace
}  // namespace lucarne::gi
