// The viewer in a real window: an X server without a screen (Xvfb), driven as a user would (xdotool).
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include "io/image/image.h"
#include "tests/viewer/measured_scan.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

using test::Outcome;
using test::shell;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr int kWidth = 480, kHeight = 360;
constexpr auto kPatience = std::chrono::seconds(120);  ///< ends a test that hangs; nothing is measured by it

bool installed(const std::string& program) {
    return shell("command -v " + program).code == 0;
}

/// A program in the background, ended with this object.
class Background {
 public:
    explicit Background(const std::string& command) {
        pid_ = fork();
        if (pid_ == 0) {
            execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
            _exit(127);
        }
    }
    ~Background() {
        if (running()) {
            kill(pid_, SIGTERM);
            waitpid(pid_, nullptr, 0);
        }
    }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool running() {
        int status = 0;
        if (pid_ > 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
            code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            pid_ = -1;
        }
        return pid_ > 0;
    }
    std::optional<int> code() const { return code_; }

 private:
    pid_t pid_ = -1;
    std::optional<int> code_;
};

/// Polls until `there` holds; false once patience ends.
template <class Condition>
bool eventually(const Condition& there) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
        if (there()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

double difference(const io::Image8& a, const io::Image8& b) {  ///< mean, of 255
    double sum = 0;
    for (size_t i = 0; i < a.bytes.size(); ++i) sum += std::abs(double(a.bytes[i]) - double(b.bytes[i]));
    return sum / static_cast<double>(a.bytes.size());
}

double deviation(const io::Image8& image) {  ///< standard, of 255
    double sum = 0, squares = 0;
    for (const uint8_t byte : image.bytes) {
        sum += byte;
        squares += double(byte) * byte;
    }
    const double n = static_cast<double>(image.bytes.size());
    return std::sqrt(squares / n - (sum / n) * (sum / n));
}

class ViewerWindow : public testing::Test {
 protected:
    void SetUp() override {
        if (!installed("Xvfb") || !installed("xdotool")) GTEST_SKIP() << "needs Xvfb and xdotool";
        const std::string number = folder_ / "display";
        server_.emplace("Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp -noreset 3>" + number +
                        " 2>/dev/null");
        ASSERT_TRUE(eventually([&] { return test::bytes_of(number).find('\n') != std::string::npos; }))
            << "Xvfb does not start";
        display_ = "DISPLAY=:" + test::bytes_of(number).substr(0, test::bytes_of(number).size() - 1) + " ";
        cache_ = make_cornell(folder_);
    }

    void start(const std::string& more = "") {
        // LeakSanitizer would report what X's and Mesa's drivers, unloaded by then, have left: modules
        // without a name, which no suppression can match.
        const std::string environment = display_ + "ASAN_OPTIONS=detect_leaks=0 ";
        viewer_.emplace("env -C " + folder_.path().string() + " " + environment + LUCARNE_BINARY + " view " +
                        cache_ + " --engine direct --size " + std::to_string(kWidth) + "x" +
                        std::to_string(kHeight) + more);
        ASSERT_TRUE(
            eventually([&] { return !viewer_->running() || xdo("search --name 'Lucarne - '").code == 0; }));
        ASSERT_TRUE(viewer_->running()) << "it ended at once";
    }
    Outcome xdo(const std::string& command) const { return shell(display_ + "xdotool " + command); }
    void drag(int button, int from_x, int from_y, int to_x, int to_y) const {
        const auto at = [](int x, int y) { return std::to_string(x) + " " + std::to_string(y); };
        std::string moves = "mousemove " + at(from_x, from_y) + " sleep 0.3 mousedown " +
                            std::to_string(button) + " sleep 0.3";
        for (int step = 1; step <= 5; ++step)
            moves += " mousemove " +
                     at(from_x + (to_x - from_x) * step / 5, from_y + (to_y - from_y) * step / 5) +
                     " sleep 0.1";
        EXPECT_EQ(xdo(moves + " mouseup " + std::to_string(button)).code, 0);
    }

    /// The picture at rest: saved by the viewer's own key until it is whole and `wanted` accepts it.
    template <class Wanted>
    std::optional<io::Image8> picture(const Wanted& wanted) {
        std::optional<io::Image8> result;
        eventually([&] {
            if (!viewer_->running()) return true;
            const std::string file = folder_ / "lucarne-0001.png";
            std::error_code ignored;
            std::filesystem::remove(file, ignored);
            xdo("key F12");
            for (int i = 0; i < 20 && !std::filesystem::exists(file); ++i)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            const auto saved = io::read_png(file);
            if (!saved || saved->width != kWidth || saved->height != kHeight || !wanted(*saved)) return false;
            result = *saved;
            return true;
        });
        return result;
    }
    static bool lit(const io::Image8& image) { return deviation(image) > 10; }

    TemporaryFolder folder_;
    std::optional<Background> server_, viewer_;
    std::string display_, cache_;
};

TEST_F(ViewerWindow, OrbitsAndMovesTheLightAndComesHome) {
    start();
    const auto first = picture(lit);
    ASSERT_TRUE(first) << "no picture that is not blank";
    xdo("key Tab");  // the panels would take the drags
    drag(1, 250, 300, 300, 320);
    const auto turned = picture([&](const io::Image8& now) { return difference(now, *first) > 2; });
    ASSERT_TRUE(turned) << "dragging turns nothing";
    EXPECT_TRUE(lit(*turned));
    xdo("key Home");
    ASSERT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) < 0.5; }))
        << "Home does not lead back";

    drag(1, 250, 300, 200, 290);
    const auto before = picture([&](const io::Image8& now) { return difference(now, *first) > 2; });
    ASSERT_TRUE(before);
    xdo("key l");
    const auto lamp = picture([&](const io::Image8& now) { return difference(now, *before) > 2; });
    ASSERT_TRUE(lamp) << "L does not move the light";
    xdo("keydown shift");
    drag(1, 240, 300, 280, 340);
    xdo("keyup shift");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *lamp) > 0.5; }))
        << "Shift and drag do not aim";
    xdo("key ctrl+q");
    EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
}

/// Mean of the bytes of some rows.
double brightness(const io::Image8& image, uint32_t from_row, uint32_t to_row) {
    double sum = 0;
    for (size_t i = size_t{from_row} * image.width * 3; i < size_t{to_row} * image.width * 3; ++i)
        sum += image.bytes[i];
    return sum / (static_cast<double>(to_row - from_row) * image.width * 3);
}

TEST_F(ViewerWindow, SwitchesLightAndColoursByKeysAndRaisesAClipsTopByItsHandle) {
    // The camera looks straight at the edge of what the clip leaves of the box.
    start(" --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json --clip-box=-1,-1,-1,7,7,2.75");
    const auto lower_half = [](const io::Image8& now) {
        return brightness(now, 0, 170) < 1 && brightness(now, 200, 360) > 20;
    };
    const auto first = picture(lower_half);
    ASSERT_TRUE(first) << "the clip does not hold";
    xdo("key Tab");  // the panels would take the drags
    xdo("key u");
    const auto unlit =
        picture([&](const io::Image8& now) { return lower_half(now) && difference(now, *first) > 2; });
    ASSERT_TRUE(unlit) << "U does not switch the light off";
    for (const char* key : {"c", "c"}) xdo(std::string("key ") + key);  // intensity, elevation
    const auto heights =
        picture([&](const io::Image8& now) { return lower_half(now) && difference(now, *unlit) > 5; });
    ASSERT_TRUE(heights) << "C does not colour";
    // The handle in the middle of the clip's top, 10.6 m away and .25 m to the right.
    drag(1, 252, 180, 252, 120);
    EXPECT_TRUE(picture([](const io::Image8& now) {
        return brightness(now, 140, 165) > 20 && brightness(now, 0, 90) < 1;
    })) << "the handle does not move the face, or more than that";
}

TEST_F(ViewerWindow, FliesWithTheKeys) {
    start();
    const auto first = picture(lit);
    ASSERT_TRUE(first);
    xdo("key f");
    xdo("keydown w sleep 0.7 keyup w");
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *first) > 2; }));
}

TEST_F(ViewerWindow, SavesItselfForScripts) {
    const std::string file = folder_ / "window.png";
    start(" --screenshot " + file + " --frames 2");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
    const auto window = io::read_png(file);
    ASSERT_TRUE(window);
    EXPECT_EQ(window->width, uint32_t{kWidth});
    EXPECT_TRUE(lit(*window));
}

TEST_F(ViewerWindow, AScanAsItIsEndsAsThePictureOfItsCache) {
    start();
    std::optional<io::Image8> before;
    const auto of_cache = picture([&](const io::Image8& now) {  // the first ones may lack nodes
        const bool same = before && difference(now, *before) < 0.02;
        before = now;
        return same && lit(now);
    });
    ASSERT_TRUE(of_cache);
    viewer_.reset();
    cache_ = folder_ / "cornell.las";
    start();
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(cache_ + ".luc"); })) << "no cache is kept";
    EXPECT_TRUE(picture([&](const io::Image8& now) { return difference(now, *of_cache) < 0.05; }))
        << "the picture stays another than the cache's";
}

TEST_F(ViewerWindow, ClosedWhileItConvertsItEndsWellAndLeavesNoHalfOfACache) {
    cache_ = folder_ / "large.las";
    ASSERT_EQ(test::lucarne("generate nave --points 400k -o " + cache_).code, 0);
    start();
    ASSERT_TRUE(picture(lit));
    xdo("key ctrl+q");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
    EXPECT_EQ(viewer_->code(), 0);
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
        const std::string name = entry.path().filename();
        EXPECT_EQ(name.find(".part"), std::string::npos) << name;
        if (name == "large.las.luc") {
            EXPECT_EQ(test::lucarne("verify " + entry.path().string()).code, 0);
        }
    }
}

TEST_F(ViewerWindow, MeasuresAKnownDistanceByClicksAndSavesItWithTheScansOwnDigits) {
    const test::MeasuredScan scan;
    cache_ = scan.file();
    const std::string scene = folder_ / "front.json";
    const glm::dvec3 from = test::MeasuredScan::kCorner + glm::dvec3(2, -4, 1.5);
    std::ofstream(scene) << fmt::format(
        R"({{"cameras": [{{"name": "front", "position": [{0}, {1}, {2}], "target": [{0}, {3}, {2}], "fov": 50}}],
            "lights": [{{"type": "point", "position": [{0}, {1}, {2}], "intensity": [50, 50, 50]}}]}})",
        from.x, from.y, from.z, from.y + 4);
    start(" --scene " + scene);
    ASSERT_TRUE(picture(lit));
    xdo("key Tab");
    xdo("key ctrl+2");
    xdo("key m");  // the panel would take clicks on the right
    // Where points of the front wall are seen, by number: 10th and 66th of the third row.
    const auto click = [&](uint64_t number) {
        const glm::dvec3 d = test::MeasuredScan::position(number) - from;
        const double half = std::tan(25.0 / 180 * M_PI);
        const double x = kWidth / 2.0 + d.x / d.y / half * kHeight / 2.0;
        const double y = kHeight / 2.0 - d.z / d.y / half * kHeight / 2.0;
        EXPECT_EQ(xdo(fmt::format("mousemove {:.0f} {:.0f} sleep 0.4 click 1 sleep 0.4", std::floor(x),
                                  std::floor(y)))
                      .code,
                  0);
    };
    const uint64_t a = 9 + 2 * test::MeasuredScan::kAcross, b = 65 + 2 * test::MeasuredScan::kAcross;
    click(a);
    click(b);
    const std::string file = folder_ / "measurements.csv";
    ASSERT_TRUE(eventually([&] {
        xdo("key ctrl+e sleep 0.3");
        return !viewer_->running() || std::filesystem::exists(file);
    })) << "nothing was measured";
    const std::string csv = test::bytes_of(file);
    const auto digits = [](uint64_t number) {
        const glm::ivec3 p = test::MeasuredScan::integers(number);
        return fmt::format("{}.{:03},{}.{:03},{}.{:03}", 1'500'000 + p.x / 1000, p.x % 1000,
                           200'000 + p.y / 1000, p.y % 1000, p.z / 1000, p.z % 1000);
    };
    EXPECT_THAT(csv, HasSubstr("Distance 1,distance,point 1,,," + digits(a)));
    EXPECT_THAT(csv, HasSubstr("Distance 1,distance,point 2,,," + digits(b)));
    const size_t at = csv.find("Distance 1,distance,length,");
    ASSERT_NE(at, std::string::npos) << csv;
    EXPECT_NEAR(std::stod(csv.substr(at + 27)), 56 * 0.05 * test::MeasuredScan::kFoot, 1e-9) << "metres";
}

TEST(Viewer, WithoutADisplayItSaysSoInOneLine) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder, "2k");
    const Outcome outcome = shell("env -u DISPLAY -u WAYLAND_DISPLAY " LUCARNE_BINARY " view " + cache);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("lucarne: window: "));
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
}

}  // namespace
}  // namespace lucarne
