#include "viewer/window/actions/actions.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

TEST(Actions, EachHasAKeyOfItsOwnAPlaceInAMenuAndAName) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    for (const BoundAction& action : actions) {
        EXPECT_NE(action.chord.key, 0) << action.name;
        EXPECT_NE(std::string(action.menu), "") << action.name;
        EXPECT_TRUE(action.run && action.enabled && action.checked) << action.name;
        for (const BoundAction& other : actions) {
            if (&other == &action) continue;
            EXPECT_NE(other.chord, action.chord)
                << key_text(action.chord) << ": " << action.name << " and " << other.name;
            EXPECT_FALSE(std::string(other.name) == action.name && std::string(other.menu) == action.menu)
                << action.name;
        }
    }
}

TEST(Actions, LeaveTheKeysThatFlyAlone) {
    ViewModel model(10);
    for (const BoundAction& action : bound_actions(model))
        for (const int key : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E})
            EXPECT_NE(action.chord, (KeyChord{key, 0})) << action.name;
}

TEST(Actions, KeysAreWrittenAsPeopleWriteThem) {
    EXPECT_EQ(key_text({GLFW_KEY_O, GLFW_MOD_CONTROL}), "Ctrl+O");
    EXPECT_EQ(key_text({GLFW_KEY_F12, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT}),
              "Ctrl+Alt+Shift+F12");
    EXPECT_EQ(key_text({GLFW_KEY_PAGE_UP}), "Page up");
    ViewModel model(10);
    for (const BoundAction& action : bound_actions(model))
        EXPECT_EQ(key_text(action.chord).find("key "), std::string::npos);
}

TEST(Actions, RunByTheirKeyWithWhatIsHeldDownBesideItAndOnlyWhereEnabled) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    const KeyChord help{GLFW_KEY_F1}, help_shifted{GLFW_KEY_F1, GLFW_MOD_SHIFT}, picture{GLFW_KEY_F12};
    run_actions(actions, std::array{help_shifted});
    EXPECT_FALSE(model.show_help);
    run_actions(actions, std::array{help, picture});
    EXPECT_TRUE(model.show_help);
    EXPECT_TRUE(model.commands.empty()) << "there is no picture to save";
}

}  // namespace
}  // namespace lucarne::viewer
