// Ranges, groups and arguments of kernels, and the times of passes that run them.
#include "gi/device/cl/cl_kernel.h"

#include <numeric>

#include <glm/vec4.hpp>
#include <gmock/gmock.h>

#include "gi/device/gl/pass_times.h"
#include "tests/gi/device/cl/on_opencl.h"

namespace lucarne::gi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kKernels = R"(
kernel void sizes(global uint* sizes) {
    if (get_global_id(0) + get_global_id(1) + get_global_id(2) > 0) return;
    sizes[0] = get_work_dim();
    for (uint i = 0; i < 3; ++i) {
        sizes[1 + i] = get_global_size(i);
        sizes[4 + i] = get_local_size(i);
    }
}
kernel void count(global uint* runs, uint width, uint height) {
    uint x = get_global_id(0), y = get_global_id(1), z = get_global_id(2);
    if (x < width && y < height) runs[(z * height + y) * width + x] += 1;
}
// Sums a group's words in memory that the group shares.
kernel void sum(global const uint* words, local uint* shared, global uint* sums) {
    uint own = get_local_id(0);
    shared[own] = words[get_global_id(0)];
    for (uint step = get_local_size(0) / 2; step > 0; step /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < step) shared[own] += shared[own + step];
    }
    if (own == 0) sums[get_group_id(0)] = shared[0];
}
kernel void own_and_given(local uint* given, global uint* out) {
    local uint own[1024];
    own[get_local_id(0)] = 3;
    given[get_local_id(0)] = 4;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_global_id(0)] = own[get_local_id(0)] + given[get_local_id(0)];
}
kernel void values(float4 a, uint4 b, int c, float d, uint e, global float* out) {
    out[0] = a.w; out[1] = b.z; out[2] = c; out[3] = d; out[4] = e;
}
// Takes some time that no compiler removes.
kernel void work(global uint* words, uint rounds) {
    uint word = get_global_id(0);
    for (uint i = 0; i < rounds; ++i) word = word * 1664525u + 1013904223u;
    words[get_global_id(0)] = word;
}
)";

class ClKernelTest : public OnOpenCl {
 protected:
    void SetUp() override {
        OnOpenCl::SetUp();
        if (!opencl) return;
        device->add_shader("kernels.cl", kKernels);
        auto made = opencl->buffer(kWords * sizeof(uint32_t), "words");
        ASSERT_TRUE(made) << made.error().line();
        words = std::move(*made);
        fill(std::vector<uint32_t>(kWords));
    }
    void TearDown() override {
        words = ClBuffer();
        OnOpenCl::TearDown();
    }
    const ClKernel& kernel(const char* name) {
        const auto found = opencl->kernel("kernels.cl", name);
        if (!found) throw std::runtime_error(found.error().line());
        return **found;
    }
    void fill(const std::vector<uint32_t>& values) {
        ASSERT_TRUE(words.upload(0, std::as_bytes(std::span(values))));
    }
    std::vector<uint32_t> first(size_t count) const {
        std::vector<uint32_t> values(count);
        EXPECT_TRUE(words.download(0, std::as_writable_bytes(std::span(values))));
        return values;
    }

    static constexpr size_t kWords = 4096;
    ClBuffer words;
};

TEST_F(ClKernelTest, RunsInOneTwoAndThreeDimensionsInWholeGroups) {
    ASSERT_TRUE(kernel("sizes").run(ClRange(100, 16), words));
    EXPECT_THAT(first(7), ElementsAre(1, 112, 1, 1, 16, 1, 1));
    ASSERT_TRUE(kernel("sizes").run(ClRange({30, 17}, {8, 4}), words));
    EXPECT_THAT(first(7), ElementsAre(2, 32, 20, 1, 8, 4, 1));
    ASSERT_TRUE(kernel("sizes").run(ClRange({5, 6, 7}, {4, 2, 3}), words));
    EXPECT_THAT(first(7), ElementsAre(3, 8, 6, 9, 4, 2, 3));
}

TEST_F(ClKernelTest, RunsOncePerItem) {
    const uint32_t width = 13, height = 9, depth = 5;
    ASSERT_TRUE(kernel("count").run(ClRange({width, height, depth}, {4, 4, 1}), words, width, height));
    EXPECT_THAT(first(width * height * depth), testing::Each(1u));
}

TEST_F(ClKernelTest, WithoutAGroupSizeRunsExactlyTheItems) {
    ASSERT_TRUE(kernel("sizes").run(ClRange({30, 17}), words));
    const auto sizes = first(4);
    EXPECT_THAT(sizes, ElementsAre(2, 30, 17, 1));
    ASSERT_TRUE(kernel("sizes").run(ClRange(31), words));
    EXPECT_EQ(first(2)[1], 31u);
}

TEST_F(ClKernelTest, WithoutItemsDoesNothing) {
    fill({7, 7});
    EXPECT_TRUE(kernel("sizes").run(ClRange(0, 64), words));
    EXPECT_TRUE(kernel("sizes").run(ClRange({8, 0}, {8, 8}), words));
    EXPECT_THAT(first(2), ElementsAre(7, 7));
}

TEST_F(ClKernelTest, RefusesGroupsThatTheDeviceCannotRun) {
    const auto refused = kernel("sizes").run(ClRange({1, 1}, {size_t{1} << 20, size_t{1} << 20}), words);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what, "kernel sizes of kernels.cl");
    EXPECT_THAT(refused.error().why, HasSubstr("1048576 x 1048576 x 1 work-items are more than a group has"));
}

TEST_F(ClKernelTest, TakesMemoryThatAGroupShares) {
    auto sums = opencl->buffer(16 * sizeof(uint32_t), "sums");
    ASSERT_TRUE(sums);
    std::vector<uint32_t> numbers(kWords);
    std::iota(numbers.begin(), numbers.end(), 0u);
    fill(numbers);
    ASSERT_TRUE(kernel("sum").run(ClRange(16 * 64, 64), words, ClLocal{64 * sizeof(uint32_t)}, *sums));
    std::vector<uint32_t> found(16);
    ASSERT_TRUE(sums->download(0, std::as_writable_bytes(std::span(found))));
    for (uint32_t group = 0; group < 16; ++group) EXPECT_EQ(found[group], 64 * 64 * group + 63 * 32);
}

TEST_F(ClKernelTest, RefusesMoreSharedMemoryThanTheDeviceHas) {
    const uint64_t most = opencl->info().local_memory;
    const auto refused = kernel("sum").run(ClRange(64, 64), words, ClLocal{most + 1}, words);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what, "kernel sum of kernels.cl");
    EXPECT_THAT(refused.error().why,
                HasSubstr(std::to_string(most + 1) + " bytes of local memory are more than a group has"));
    EXPECT_THAT(refused.error().why, HasSubstr(std::to_string(most) + " bytes"));

    const auto both = kernel("own_and_given").run(ClRange(1, 1), ClLocal{most - 1024}, words);
    ASSERT_FALSE(both) << "the kernel's own 4096 bytes count, too";
    EXPECT_THAT(both.error().why, HasSubstr(std::to_string(most + 3072) + " bytes"));
    ASSERT_TRUE(kernel("own_and_given").run(ClRange(1, 1), ClLocal{1024}, words));
    EXPECT_EQ(first(1)[0], 7u);
    EXPECT_TRUE(device->check());
}

TEST_F(ClKernelTest, TakesNumbersAndStructuresByValue) {
    const auto ran =
        kernel("values").run(ClRange(1), glm::vec4(1, 2, 3, 4), glm::uvec4(5, 6, 7, 8), -9, 0.5f, 11u, words);
    ASSERT_TRUE(ran) << ran.error().line();
    std::vector<float> found(5);
    ASSERT_TRUE(words.download(0, std::as_writable_bytes(std::span(found))));
    EXPECT_THAT(found, ElementsAre(4, 7, -9, 0.5f, 11));
    const auto wrong = kernel("values").run(ClRange(1), 1u);
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().why, HasSubstr("argument 0"));
    static_assert(!ClStruct<std::span<const float>> && !ClStruct<std::string_view> && !ClStruct<ClBuffer>);
}

TEST_F(ClKernelTest, ItsTimeFallsInThePassThatRanItByEitherClock) {
    const ClKernel& work = kernel("work");
    ASSERT_TRUE(work.run(ClRange(64, 64), words, 1u));  // so that the driver has compiled it
    ASSERT_TRUE(opencl->finish());
    EXPECT_FALSE(opencl->is_busy());
    for (const PassTimes::Clock clock : {PassTimes::Clock::wall, PassTimes::Clock::queries}) {
        PassTimes times(*device, clock);
        ASSERT_TRUE(work.run(ClRange(kWords, 64), words, 20'000u));  // before any pass
        times.begin("first");
        EXPECT_FALSE(opencl->is_busy()) << "what came before is not this pass's";
        ASSERT_TRUE(work.run(ClRange(kWords, 64), words, 100'000u));
        EXPECT_TRUE(opencl->is_busy());
        times.end();
        EXPECT_FALSE(opencl->is_busy()) << "nothing is left for the next pass";
        times.begin("second");
        times.end();
        times.finish();
        ASSERT_EQ(times.passes().size(), 2u);
        EXPECT_GT(times.passes()[0].seconds, 0);
    }
    ASSERT_TRUE(work.run(ClRange(kWords, 64), words, 1u));
    EXPECT_TRUE(opencl->is_busy());
    device->finish();
    EXPECT_FALSE(opencl->is_busy());
}

}  // namespace
}  // namespace lucarne::gi
