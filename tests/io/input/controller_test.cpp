// 6-DoF controllers: reports, mapping, and a device that umockdev replays into libusb.
#include "io/input/controller.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/core/random.h"
#include "tests/io/input/replayed_controller.h"
#include "tests/temporary_folder.h"

namespace lucarne::io {
namespace {

using test::axes_report;

bool take(const std::vector<uint8_t>& report, SixDofState& state) {
    return take_report(std::as_bytes(std::span(report)), state);
}

TEST(SixDof, ReportsAreInTheUsersAxes) {
    SixDofState state;
    ASSERT_TRUE(take(axes_report(1, 350, -175, 70), state));
    EXPECT_EQ(state.push, glm::dvec3(1, -0.2, 0.5)) << "right, up, forward";
    ASSERT_TRUE(take(axes_report(2, 35, -350, -70), state));
    EXPECT_EQ(state.turn, glm::dvec3(0.1, 0.2, 1)) << "nose up, nose left, right side down";
    EXPECT_EQ(state.push, glm::dvec3(1, -0.2, 0.5)) << "stays until the next report of it";
    ASSERT_TRUE(take({3, 0x02, 0x01}, state));
    EXPECT_EQ(state.buttons, 0x102u);
}

TEST(SixDof, OneReportMayHoldAllSixAxes) {
    SixDofState state;
    auto report = axes_report(1, 350, 0, 0);
    const auto turn = axes_report(2, 0, 0, -350);
    report.insert(report.end(), turn.begin() + 1, turn.end());
    ASSERT_TRUE(take(report, state));
    EXPECT_EQ(state.push, glm::dvec3(1, 0, 0));
    EXPECT_EQ(state.turn, glm::dvec3(0, 1, 0));
}

TEST(SixDof, OddReportsChangeNothingOrStayInRange) {
    Random random(1);
    for (int i = 0; i < 100000; ++i) {
        std::vector<uint8_t> report(random.next() % 20);
        for (auto& byte : report) byte = static_cast<uint8_t>(random.next());
        if (!report.empty() && i % 2) report[0] = static_cast<uint8_t>(1 + i / 2 % 3);
        SixDofState state;
        const SixDofState before = state;
        if (!take(report, state)) {
            EXPECT_EQ(state, before);
        }
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_LE(std::abs(state.push[axis]), 1);
            ASSERT_LE(std::abs(state.turn[axis]), 1);
        }
    }
}

TEST(SixDof, TheMappingIsStillAtRestAndFullAtFullTravel) {
    SixDofState state;
    state.push = {0.04, 1, -0.5};
    SixDofMapping mapping;
    const SixDofState plain = mapping.apply(state);
    EXPECT_EQ(plain.push.x, 0);
    EXPECT_EQ(plain.push.y, 1);
    EXPECT_NEAR(plain.push.z, -0.45 / 0.95, 1e-12);
    mapping.from = {2, 1, 0, 3, 4, 5};
    mapping.scale = {-1, 0, 1, 1, 1, 1};
    mapping.sensitivity = 2;
    const SixDofState mapped = mapping.apply(state);
    EXPECT_NEAR(mapped.push.x, 2 * 0.45 / 0.95, 1e-12);
    EXPECT_EQ(mapped.push.y, 0);
    EXPECT_TRUE(mapping.apply({}).at_rest());
    // It is continuous at the edge of the dead zone.
    state.push.x = 0.05 + 1e-9;
    EXPECT_LT(SixDofMapping{}.apply(state).push.x, 1e-8);
}

/// Runs one of this program's tests, which is skipped otherwise, under umockdev.
int run_replayed(const std::string& name, const std::vector<test::Answer>& answers) {
    const lucarne::test::Folder folder;
    auto words = test::under_umockdev(folder.path(), answers);
    words.push_back(std::filesystem::read_symlink("/proc/self/exe"));
    words.push_back("--gtest_also_run_disabled_tests");
    words.push_back("--gtest_filter=Replayed.DISABLED_" + name);
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        execvp(argv[0], argv.data());
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Collects what a controller reports.
class Heard {
 public:
    void add(const SixDofState& state, const ControllerStatus& status) {
        const std::lock_guard lock(mutex_);
        states_.push_back(state);
        statuses_.push_back(status);
        more_.notify_all();
    }
    template <class Is>
    bool wait_for(const Is& is) {
        std::unique_lock lock(mutex_);
        // The time only ends a test that hangs.
        return more_.wait_for(lock, std::chrono::minutes(5), [&] { return is(states_, statuses_); });
    }

 private:
    std::mutex mutex_;
    std::condition_variable more_;
    std::vector<SixDofState> states_;
    std::vector<ControllerStatus> statuses_;
};

TEST(Replayed, DISABLED_PushTurnButtonAndUnplugging) {
    Heard heard;
    std::atomic<Controller*> of = nullptr;
    const auto controller = Controller::start([&] {
        if (Controller* c = of) heard.add(c->state(), c->status());
    });
    of = controller.get();
    heard.add(controller->state(), controller->status());
    using States = std::vector<SixDofState>;
    using Statuses = std::vector<ControllerStatus>;
    EXPECT_TRUE(heard.wait_for([](const States& states, const Statuses&) {
        return std::ranges::any_of(states, [](const auto& s) { return s.push == glm::dvec3(0, 0, 1); });
    })) << "pushed forward";
    EXPECT_TRUE(heard.wait_for([](const States& states, const Statuses&) {
        return std::ranges::any_of(states, [](const auto& s) { return s.turn == glm::dvec3(0, -1, 0); });
    })) << "turned right";
    EXPECT_TRUE(heard.wait_for([](const States& states, const Statuses&) {
        return std::ranges::any_of(states, [](const auto& s) { return s.buttons == 1; });
    })) << "button";
    EXPECT_TRUE(heard.wait_for([](const States& states, const Statuses& statuses) {
        return statuses.back().kind == ControllerStatus::Kind::none && states.back() == SixDofState{} &&
               std::ranges::any_of(statuses,
                                   [](const auto& s) { return s.kind == ControllerStatus::Kind::connected; });
    })) << "unplugged, and at rest though its last word was a push";
    EXPECT_EQ(controller->take_pressed(), 1u);
    EXPECT_EQ(controller->take_pressed(), 0u);
}

TEST(Controller, AReplayedDeviceIsHeardUntilItIsUnplugged) {
    if (std::system("command -v umockdev-run >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "umockdev is not installed";
    EXPECT_EQ(run_replayed("PushTurnButtonAndUnplugging", {{axes_report(1, 0, 0, 0), 0, 500},
                                                           {axes_report(1, 0, -350, 0)},
                                                           {axes_report(2, 0, 0, 350)},
                                                           {{3, 1, 0}},
                                                           {{3, 0, 0}},
                                                           {axes_report(1, 350, 0, 0)},
                                                           {{}, -19}}),
              0);
}

TEST(Controller, WithoutADeviceItSaysSoAndEndsAtOnce) {
    const auto controller = Controller::start([] {});
    EXPECT_TRUE(controller->state().at_rest());
    EXPECT_EQ(controller->take_pressed(), 0u);
}

}  // namespace
}  // namespace lucarne::io
