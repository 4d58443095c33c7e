// The variable LUCARNE_CL_DEVICE chooses the OpenCL device by its name.
#include "gi/device/cl/cl_choice.h"

#include <cctype>
#include <cstdlib>

#include <gmock/gmock.h>

#include "gi/device/cl/cl_device.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using testing::HasSubstr;

class ClChoice : public OnDevice {
 protected:
    void TearDown() override {
        ::unsetenv("LUCARNE_CL_DEVICE");
        OnDevice::TearDown();
    }
    static void choose(const std::string& name) { ::setenv("LUCARNE_CL_DEVICE", name.c_str(), 1); }
};

TEST_F(ClChoice, TakesADeviceByAPartOfItsNameInAnyCase) {
    const auto first = device->opencl();
    ASSERT_TRUE(first) << first.error().line();
    const std::string name = (*first)->info().name;
    std::string part = name.substr(0, 5);
    for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    choose(part);
    OnDevice::SetUp();
    const auto chosen = device->opencl();
    ASSERT_TRUE(chosen) << chosen.error().line();
    EXPECT_EQ((*chosen)->info().name.substr(0, 5), name.substr(0, 5));
    choose("");
    EXPECT_TRUE(opencl_available()) << "an empty name means any device";
}

TEST_F(ClChoice, OfANameThatNoDeviceHasIsAnErrorThatNamesThoseAtHand) {
    const auto first = device->opencl();
    ASSERT_TRUE(first) << first.error().line();
    const std::string name = (*first)->info().name;
    choose("Babbage 9000");
    OnDevice::SetUp();
    const auto none = device->opencl();
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().line(), HasSubstr("\"Babbage 9000\" (LUCARNE_CL_DEVICE)"));
    EXPECT_THAT(none.error().todo, HasSubstr(name));
    EXPECT_FALSE(opencl_available());
    choose(name);
    EXPECT_TRUE(device->opencl()) << "an engine may ask again";
}

}  // namespace
}  // namespace lucarne::gi
