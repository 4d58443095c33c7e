#include "viewer/frame/presets.h"

#include <set>

#include <gtest/gtest.h>

#include "gi/lighting/light_options.h"

namespace lucarne::viewer {
namespace {

TEST(Presets, UnknownPresetIsABadArgumentThatListsTheKnownOnes) {
    const auto preset = find_preset("best");
    ASSERT_FALSE(preset);
    EXPECT_EQ(preset.error().kind, ErrorKind::arguments);
    for (const auto& known : presets()) EXPECT_NE(preset.error().line().find(known.name), std::string::npos);
}

TEST(Presets, EachCostsMoreThanTheOneBefore) {
    std::set<std::string_view> names;
    for (size_t i = 0; i < presets().size(); ++i) {
        names.insert(presets()[i].name);
        if (i == 0) continue;
        EXPECT_GT(presets()[i].engine[gi::kVpls], presets()[i - 1].engine[gi::kVpls]);
        EXPECT_GT(presets()[i].budgets.light, presets()[i - 1].budgets.light);
    }
    EXPECT_EQ(names.size(), presets().size());
    EXPECT_TRUE(names.contains(kDefaultPreset));
}

}  // namespace
}  // namespace lucarne::viewer
