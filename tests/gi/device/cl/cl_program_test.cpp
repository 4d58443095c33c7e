// Programs are compiled once for all their kernels, and again when their files change.
#include "gi/device/cl/cl_program.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/gi/device/cl/on_opencl.h"
#include "tests/temporary_folder.h"

namespace lucarne::gi {
namespace {

using testing::HasSubstr;

/// Returns a program of two kernels that write a number, and its double.
std::string numbers(const std::string& number) {
    return "kernel void once(global uint* out) {\n    out[0] = " + number +
           ";\n}\nkernel void twice(global uint* out) {\n    out[0] = 2 * (" + number + ");\n}\n";
}

class ClProgramTest : public OnOpenCl {
 protected:
    void SetUp() override {
        OnOpenCl::SetUp();
        if (device) device->add_shader(kPath, numbers("7"));
    }
    const ClKernel* kernel(const char* name, const Defines& defines = {}) {
        const auto found = opencl->kernel(kPath, name, defines);
        EXPECT_TRUE(found) << found.error().line();
        return found ? *found : nullptr;
    }
    /// Returns what the kernel writes.
    uint32_t result(const ClKernel* kernel) {
        auto out = opencl->buffer(16, "out");
        if (!kernel || !out || !kernel->run(ClRange(1), *out)) return 0;
        uint32_t word = 0;
        EXPECT_TRUE(out->download(0, std::as_writable_bytes(std::span(&word, 1))));
        return word;
    }

    static constexpr const char* kPath = "test/numbers.cl";
};

TEST_F(ClProgramTest, IsCompiledOnceForAllItsKernelsAndEachSetOfDefines) {
    const ClKernel* once = kernel("once");
    const ClKernel* twice = kernel("twice");
    EXPECT_EQ(opencl->programs_built(), 1u);
    EXPECT_NE(once, twice);
    EXPECT_EQ(kernel("once"), once);
    EXPECT_EQ(result(once), 7u);
    EXPECT_EQ(result(twice), 14u);
    EXPECT_FALSE(opencl->kernel(kPath, "thrice"));
    EXPECT_EQ(opencl->programs_built(), 1u);
    EXPECT_NE(kernel("once", {{"LUCARNE_OTHER", "1"}}), once);
    EXPECT_EQ(opencl->programs_built(), 2u);
}

TEST_F(ClProgramTest, IsSharedByAllWhoAskTheDeviceForIt) {
    const ClKernel* once = kernel("once");
    const auto other = device->opencl();
    ASSERT_TRUE(other);
    const auto same = (*other)->kernel(kPath, "once");
    ASSERT_TRUE(same);
    EXPECT_EQ(*same, once);
    EXPECT_EQ(opencl->programs_built(), 1u);
}

/// The program's file on disk.
class ClProgramFiles : public ClProgramTest {
 protected:
    void write(const std::string& text) const {
        std::filesystem::create_directories(folder_ / "test");
        std::ofstream(folder_ / kPath) << text;
    }
    test::Folder files_;
    const std::filesystem::path& folder_ = files_.path();
};

TEST_F(ClProgramFiles, AreUsedInPlaceOfTheProgramsOwnAndReadAgainOnDemand) {
    const ClKernel* early = kernel("once");
    EXPECT_EQ(result(early), 7u);
    write(numbers("8"));
    device->use_shader_folder(folder_);
    EXPECT_EQ(result(early), 8u) << "a kernel that an engine holds";
    write(numbers("9"));
    EXPECT_EQ(result(kernel("twice")), 16u) << "nobody asked to read it again";
    device->reload_shaders();
    EXPECT_EQ(result(early), 9u);
    EXPECT_EQ(kernel("once"), early);
    EXPECT_EQ(result(kernel("twice")), 18u);
    EXPECT_EQ(device->shader_problem(), "");
    const uint32_t built = opencl->programs_built();
    device->reload_shaders();
    EXPECT_EQ(opencl->programs_built(), built) << "nothing has changed";
}

TEST_F(ClProgramFiles, ABrokenOneIsNamedWithItsLineAndTheLastGoodProgramStays) {
    write(numbers("8"));
    device->use_shader_folder(folder_);
    const ClKernel* once = kernel("once");
    EXPECT_EQ(result(once), 8u);
    write(numbers("eight"));
    device->reload_shaders();
    EXPECT_EQ(result(once), 8u);
    EXPECT_THAT(device->shader_problem(), HasSubstr("test/numbers.cl:2"));
    write("kernel void twice(global uint* out) { out[0] = 5; }\n");
    device->reload_shaders();
    EXPECT_EQ(result(once), 8u) << "a file without a kernel in use is broken, too";
    EXPECT_THAT(device->shader_problem(), HasSubstr("kernel once of test/numbers.cl"));
    write(numbers("10"));
    device->reload_shaders();
    EXPECT_EQ(result(once), 10u);
    EXPECT_EQ(device->shader_problem(), "") << "it is mended";
}

TEST_F(ClProgramFiles, OneThatIsBrokenFromTheStartLeavesTheProgramsOwn) {
    write(numbers("eight"));
    device->use_shader_folder(folder_);
    EXPECT_EQ(result(kernel("once")), 7u);
    EXPECT_THAT(device->shader_problem(), HasSubstr("test/numbers.cl:2"));
}

TEST_F(ClProgramFiles, OneThatLacksAKernelLeavesTheProgramsOwn) {
    write("kernel void twice(global uint* out) { out[0] = 5; }\n");
    device->use_shader_folder(folder_);
    const ClKernel* twice = kernel("twice");
    EXPECT_EQ(result(twice), 5u);
    EXPECT_EQ(result(kernel("once")), 7u);
    EXPECT_EQ(result(twice), 14u) << "all kernels of a program are of one text";
    EXPECT_THAT(device->shader_problem(), HasSubstr("kernel once of test/numbers.cl"));
}

}  // namespace
}  // namespace lucarne::gi
