// Compares the moving picture of the window with those of CloudCompare and F3D on the same cloud, and prints
// the figures beside their targets. A mouse turns the scene on a virtual screen, and the time from one
// picture to the next is measured. `lucarne_window [FOLDER] [--scale S]`: FOLDER holds the cloud, the logs
// and a picture of each program (default: a temporary folder, 400 MB). Viewers that are not installed are
// left out.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/formats/scan.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/formats.h"
#include "tests/bench/picture_times.h"
#include "tests/bench/rows.h"
#include "tests/viewer/window/picture_difference.h"
#include "tests/viewer/window/virtual_screen.h"

namespace lucarne {
namespace {

using bench::PictureTimes;
using test::Background, test::eventually;

constexpr int kWidth = 1280, kHeight = 720;  ///< of the screen and of the windows
constexpr int kReach = 150;                  ///< pixels; radius of the circle on which the mouse moves
constexpr int kMovesPerSecond = 30, kMovesPerTurn = 90;
constexpr double kDragSeconds = 10, kLeastDragSeconds = 2;
constexpr std::chrono::seconds kFirstPicture{120};  ///< the longest wait for it
constexpr int kTrials = 5;
/// Mean difference of a byte that shows that the scene has turned.
constexpr double kTurned = 0.5;

/// Returns the processor time that a program has used so far (proc(5), /proc/PID/stat, fields 14 and 15).
double cpu_seconds(const Background& program) {
    const std::string stat = test::bytes_of(fmt::format("/proc/{}/stat", program.pid()));
    std::istringstream fields(stat.substr(std::min(stat.rfind(')'), stat.size())));
    std::string skipped;
    for (int field = 2; field < 14; ++field) fields >> skipped;
    double user = 0, system = 0;
    fields >> user >> system;
    return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Returns the processor time that all programs have used so far (proc(5), /proc/stat).
double cpu_seconds_of_all() {
    std::ifstream stat("/proc/stat");
    std::string name;
    double user = 0, nice = 0, system = 0;
    stat >> name >> user >> nice >> system;
    return (user + nice + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Waits until a program has used hardly any processor time for a second. Returns false if it never rests.
bool rests(const Background& program) {
    double before = cpu_seconds(program);
    return eventually([&] {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        const double now = cpu_seconds(program);
        return now - std::exchange(before, now) < 0.1;
    });
}

struct Drag {
    double begin = 0, end = 0;  ///< monotonic seconds
    double cpu_seconds = 0;     ///< of the program
    double cpu_of_all = 0;      ///< seconds of all programs
};

/// The screen with the windows, and the cloud that they show.
class Stage {
 public:
    explicit Stage(const bench::BenchRun& run) : run_(run), screen_(kWidth, kHeight, run.folder) {}

    const test::VirtualScreen& screen() const { return screen_; }
    std::string file(const std::string& name) const { return run_.folder / name; }
    std::string scan() const { return file("points.ply"); }
    std::string cache() const { return file("nave.luc"); }

    Result<void> make_cloud() const;
    /// Waits until a window with this title is visible, while `program` runs.
    Result<void> window_appears(Background& program, const std::string& title) const;
    /// Turns the scene with the mouse. Error: the picture remains as it was. Leaves NAME.png, the last
    /// picture while moving.
    Result<Drag> turn(Background& program, const std::string& name) const;

 private:
    Result<io::Image8> picture(const std::string& name) const;
    std::string move_to(int step) const;

    const bench::BenchRun& run_;
    test::VirtualScreen screen_;
};

/// Makes the cache, and a scan with only positions and colours, which every viewer shows by itself.
Result<void> Stage::make_cloud() const {
    const std::string made = file("nave.ply");
    LUCARNE_TRY(run_lucarne(
        {"generate", "nave", "-o", made, "--points", std::to_string(run_.points(5'000'000)), "--overwrite"}));
    LUCARNE_TRY(run_lucarne({"convert", made, "-o", cache(), "--overwrite"}));
    LUCARNE_ASSIGN(const auto source, io::open_scan(made));
    const io::Attribute* color = source->schema().find(io::names::color);
    if (!color) return failed(made, "has no colours");
    io::Schema schema;
    schema.position = io::PositionType::f32;
    schema.stride = io::position_bytes(io::PositionType::f32);
    schema.add(std::string(io::names::color), io::ScalarType::u8, 3);
    std::vector<std::byte> records;
    LUCARNE_TRY(bench::for_each_record(*source, [&](const std::byte* record) {
        const glm::vec3 position(io::position_of(source->schema(), record));
        const auto* bytes = reinterpret_cast<const std::byte*>(&position);
        records.insert(records.end(), bytes, bytes + sizeof position);
        for (size_t i = 0; i < 3; ++i) {
            records.emplace_back();
            io::store_scalar(
                io::ScalarType::u8, &records.back(),
                io::scalar_at(color->type, record + color->offset + i * io::scalar_bytes(color->type)));
        }
    }));
    LUCARNE_ASSIGN(const auto writer, io::create_scan(scan(), schema, {}, {.overwrite = true}));
    LUCARNE_TRY(writer->write(records));
    std::filesystem::remove(made);
    return writer->finish();
}

Result<void> Stage::window_appears(Background& program, const std::string& title) const {
    const auto there = [&] { return screen_.xdo("search --onlyvisible --name '" + title + "'").code == 0; };
    const bool came = eventually([&] { return !program.running() || there(); });
    if (!program.running()) return failed("the program", "has ended");
    if (!came)
        return failed("window \"" + title + "\"",
                      fmt::format("has not opened in {} s", test::kPatience.count()));
    return {};
}

Result<io::Image8> Stage::picture(const std::string& name) const {
    const std::string png = file(name + ".png");
    const auto taken = test::shell(screen_.display() + "timeout -s KILL 60 import -window root PNG24:" + png);
    if (taken.code != 0) return failed("import", taken.output);
    return io::read_png(png);
}

std::string Stage::move_to(int step) const {
    const double angle = 2 * std::numbers::pi * step / kMovesPerTurn;
    return fmt::format("mousemove {:.0f} {:.0f} ", kWidth / 2 + kReach * std::cos(angle),
                       kHeight / 2 + kReach * std::sin(angle));
}

Result<Drag> Stage::turn(Background& program, const std::string& name) const {
    const int moves =
        static_cast<int>(kMovesPerSecond * std::max(kLeastDragSeconds, run_.seconds(kDragSeconds)));
    std::string path;
    for (int step = 1; step <= moves; ++step)
        path += move_to(step) + fmt::format("sleep {:.4f} ", 1.0 / kMovesPerSecond);
    screen_.xdo(move_to(0) + "sleep 0.3 mousedown 1 sleep 0.5");
    LUCARNE_ASSIGN(const io::Image8 first, picture(name));
    Drag drag;
    const double cpu_before = cpu_seconds(program), all_before = cpu_seconds_of_all();
    drag.begin = bench::monotonic_seconds();
    const test::Outcome moved = screen_.xdo(path);
    drag.end = bench::monotonic_seconds();
    drag.cpu_seconds = cpu_seconds(program) - cpu_before;
    drag.cpu_of_all = cpu_seconds_of_all() - all_before;
    const auto last = picture(name);
    screen_.xdo("mouseup 1");
    if (moved.code != 0) return failed("xdotool", moved.output);
    if (!program.running()) return failed("the program", "has ended while the scene turned");
    if (!last) return tl::make_unexpected(last.error());
    if (!(test::difference(first, *last) > kTurned))
        return failed("the picture", "has not changed while the mouse moved");
    return drag;
}

/// What a drag has shown.
struct Turned {
    PictureTimes times;
    Drag drag;

    /// Returns how many cores other programs than the viewer kept busy.
    double others() const { return (drag.cpu_of_all - drag.cpu_seconds) / (drag.end - drag.begin); }
    /// So much is not the work of Xvfb and xdotool.
    bool disturbed() const { return others() > 0.2; }
};

/// Repeats a measurement that other programs disturb, at most twice, and returns the least disturbed one.
Result<Turned> least_disturbed(const bench::BenchRun& run, const std::function<Result<Turned>()>& turn) {
    auto first = turn();
    // A trial's drag is so short that a busy machine may show too few pictures meanwhile.
    for (int again = 1; again < kTrials && !first && run.trial(); ++again) first = turn();
    LUCARNE_ASSIGN(Turned best, std::move(first));
    for (int again = 0; again < 2 && best.disturbed() && !run.trial(); ++again) {
        LUCARNE_ASSIGN(const Turned next, turn());
        if (next.others() < best.others()) best = next;
    }
    return best;
}

void print_times(const std::string& who, const Turned& turned, std::optional<double> target) {
    figure(who + ": from one picture to the next, median", turned.times.median, "ms");
    const std::string p95 = who + ": 95 % of the pictures within";
    if (target)
        row(p95, turned.times.p95, "ms", *target);
    else
        figure(p95, turned.times.p95, "ms");
    figure(fmt::format("{}: {} pictures, processor time a second", who, turned.times.pictures),
           turned.drag.cpu_seconds / (turned.drag.end - turned.drag.begin), "CPU-s");
    figure(fmt::format("{}: other programs'{}", who, turned.disturbed() ? ", which disturb it" : ""),
           turned.others(), "CPU-s");
}

/// Another viewer.
struct Peer {
    std::string name, program;
    std::string arguments;  ///< before the scan
    /// Makes its view as large as the screen. The program has just been started.
    std::function<Result<void>(const Stage&, Background&)> prepare;
};

Result<void> prepare_f3d(const Stage& stage, Background& program) {
    return stage.window_appears(program, "^F3D");
}

Result<void> prepare_cloudcompare(const Stage& stage, Background& program) {
    // A dialog proposes which properties are coordinates and colours.
    LUCARNE_TRY(stage.window_appears(program, "^Ply File Open$"));
    stage.screen().xdo("search --onlyvisible --name '^Ply File Open$' mousemove --window %1 20 20");
    stage.screen().xdo("sleep 0.5 key Return");
    if (!rests(program)) return failed(stage.scan(), "is not open yet");
    // F11 shows the view without menus and tool bars. It works only after a click, here into an empty corner
    // of the view. Without a window manager the view has to be enlarged.
    stage.screen().xdo("mousemove 380 120 sleep 0.5 click 1 sleep 0.5 key F11");
    LUCARNE_TRY(stage.window_appears(program, "^3D View 1$"));
    const std::string enlarge = fmt::format(
        "search --onlyvisible --name '^3D View 1$' windowmove 0 0 windowsize {} {}", kWidth, kHeight);
    // The search fails while other windows come and go.
    if (!eventually([&] { return stage.screen().xdo(enlarge).code == 0; }))
        return failed("the view", "cannot be enlarged");
    return {};
}

std::vector<Peer> peers() {
    return {
        {"CloudCompare", "CloudCompare", "", prepare_cloudcompare},
        // Points of the recorded colours, without a light, of the size that CloudCompare draws.
        {"F3D", "f3d",
         fmt::format(
             "--dry-run --up=+Z --geometry-only --point-size=1 --scalars=RGB --comp=-2 --resolution={},{}",
             kWidth, kHeight),
         prepare_f3d}};
}

Result<Turned> turn_peer(const Stage& stage, const Peer& peer) {
    if (!test::installed(peer.program)) return failed(peer.program, "is not installed");
    const std::string swaps = stage.file(peer.program + ".swaps"), home = stage.file(peer.program + "-home");
    // Without the user's settings, and on X11 even if the user's screen is not.
    std::filesystem::remove(swaps);
    std::filesystem::create_directory(home);
    std::filesystem::permissions(home, std::filesystem::perms::owner_all);
    Background program(
        fmt::format("env -u WAYLAND_DISPLAY {0} HOME={1} XDG_CONFIG_HOME={1} XDG_RUNTIME_DIR={1} "
                    "QT_QPA_PLATFORM=xcb LD_PRELOAD={2} "
                    "LUCARNE_SWAP_TIMES={3} {4} {5} {6} >{7} 2>&1",
                    stage.screen().display(), home, LUCARNE_SWAP_LIBRARY, swaps, peer.program, peer.arguments,
                    stage.scan(), stage.file(peer.program + ".log")));
    LUCARNE_TRY(peer.prepare(stage, program));
    if (!rests(program)) return failed(peer.program, "does not come to rest");
    LUCARNE_ASSIGN(const Drag drag, stage.turn(program, peer.program));
    LUCARNE_ASSIGN(const PictureTimes times, bench::times_of_swaps(swaps, drag.begin, drag.end));
    return Turned{times, drag};
}

Result<Turned> turn_lucarne(const Stage& stage, const std::string& engine) {
    const std::string log = stage.file("lucarne-" + engine + ".log");
    std::optional<Background> program(
        std::in_place,
        fmt::format("{} {} view {} --scene {}/data/scenes/nave.json --engine {} --size {}x{} 2>{}",
                    stage.screen().environment(), LUCARNE_BINARY, stage.cache(), LUCARNE_SOURCE_DIR, engine,
                    kWidth, kHeight, log));
    // A whole picture of the reference may take longer than this waits; it must turn nevertheless.
    eventually(
        [&] { return !program->running() || test::bytes_of(log).find("first picture") != std::string::npos; },
        std::chrono::milliseconds(100), kFirstPicture);
    if (!program->running()) return failed("lucarne view", "has ended: " + test::bytes_of(log));
    stage.screen().xdo(
        fmt::format("mousemove {} {} sleep 0.5 key Tab", kWidth / 2, kHeight / 2));  // hides the panels
    std::this_thread::sleep_for(std::chrono::seconds(3));  // loads the rest of the cut
    LUCARNE_ASSIGN(const Drag drag, stage.turn(*program, "lucarne-" + engine));
    program.reset();  // it logs at its end
    LUCARNE_ASSIGN(const PictureTimes times, bench::times_of_log(test::bytes_of(log)));
    return Turned{times, drag};
}

Result<void> measure(const bench::BenchRun& run) {
    if (!test::VirtualScreen::installed() || !test::installed("import")) {
        row_missing("the window beside other viewers",
                    "needs Xvfb, xdotool and import (Debian: imagemagick)");
        return {};
    }
    const Stage stage(run);
    if (!stage.screen().started()) return failed("Xvfb", "does not start");
    LUCARNE_TRY(stage.make_cloud());
    std::optional<double> cloudcompare, unlit;
    for (const Peer& peer : peers()) {
        const auto turned = least_disturbed(run, [&] { return turn_peer(stage, peer); });
        if (!turned) {
            row_missing(peer.name, turned.error().line());
            continue;
        }
        print_times(peer.name, *turned, std::nullopt);
        if (peer.name == "CloudCompare") cloudcompare = turned->times.median;
    }
    std::optional<Error> problem;
    for (const std::string& engine : run.cases<std::string>({"unlit", "direct", "vpl", "reference"})) {
        const auto turned = least_disturbed(run, [&] { return turn_lucarne(stage, engine); });
        if (!turned) {
            row_missing("Lucarne, " + engine, turned.error().line());
            problem = turned.error();
            continue;
        }
        print_times("Lucarne, " + engine, *turned, 100);
        if (engine == "unlit") unlit = turned->times.median;
    }
    const std::string ratio = "CloudCompare's time between pictures over Lucarne's, unlit";
    if (cloudcompare && unlit)
        row_at_least(ratio, *cloudcompare / *unlit, "times", 4);
    else
        row_missing(ratio, "one of the two is missing");
    for (const std::string& made : {stage.scan(), stage.cache()}) std::filesystem::remove(made);
    if (problem) return tl::make_unexpected(*problem);
    return {};
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
