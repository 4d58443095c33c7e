// The command line of every benchmark program: `PROGRAM [FOLDER] [SUBJECT [PART...]] [--scale S] [--OPTION
// NUMBER]...`.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/core/error.h"
#include "io/core/interrupt.h"
#include "io/core/options.h"
#include "io/files/temporary_folder.h"
#include "tests/bench/machine.h"

namespace lucarne::bench {

/// One call of a benchmark program. Functions take full sizes and return them multiplied by the scale, so
/// that a test can run the whole program in seconds. Figures can be compared with targets only at scale 1.
struct BenchRun {
    std::filesystem::path folder;           ///< for scans, caches and pictures
    double scale = 1;                       ///< factor of the full size, in (0, 1]
    std::string subject;                    ///< one of the program's subjects; empty: none is named
    std::vector<std::string> parts;         ///< what of the subject is wanted; none: all
    std::map<std::string, double> options;  ///< the program's own options, without the dashes

    bool wants(const std::string& part) const {
        return parts.empty() || std::ranges::find(parts, part) != parts.end();
    }

    uint64_t points(uint64_t full) const { return std::max<uint64_t>(scaled(full), 10'000); }
    uint64_t count(uint64_t full) const { return std::max<uint64_t>(scaled(full), 1); }
    double seconds(double full) const { return full * scale; }
    /// Whether the run only checks that the program works.
    bool trial() const { return scale < 0.05; }
    /// Returns a picture's width or height, pixels.
    uint32_t side(uint32_t full) const { return trial() ? full / 8 : full; }
    ImageSize size(ImageSize full) const { return {side(full.width), side(full.height)}; }
    /// Returns how many frames to draw.
    int frames(int full) const { return trial() ? std::min(full, 2) : full; }
    /// Returns the cases to measure: all, or only the first in a trial.
    template <class Case>
    std::vector<Case> cases(std::vector<Case> all) const {
        if (trial()) all.resize(1);
        return all;
    }
    /// Returns options for a square picture: `side` pixels with the preset, or small and fast in a trial.
    std::string picture(unsigned side, const std::string& preset) const {
        return trial() ? "--size 32x32 --preset preview "
                       : fmt::format("--size {0}x{0} --preset {1} ", side, preset);
    }
    double option(const std::string& name, double otherwise) const {
        const auto found = options.find(name);
        return found == options.end() ? otherwise : found->second;
    }

 private:
    uint64_t scaled(uint64_t full) const { return static_cast<uint64_t>(scale * static_cast<double>(full)); }
};

/// The words that a benchmark program takes beside its folder and the scale.
struct BenchWords {
    std::vector<std::string> options;     ///< with a number each, without the dashes
    std::vector<std::string> subjects;    ///< what can be measured instead of the usual
    std::vector<std::string> parts = {};  ///< of a subject; any of them may be named
};

/// Reads the arguments into `run`. Returns the first wrong argument, or an empty text.
inline std::string read_arguments(int argc, char** argv, const BenchWords& words, BenchRun& run) {
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (!argument.starts_with("--")) {
            if (std::ranges::find(words.subjects, argument) != words.subjects.end())
                run.subject = argument;
            else if (std::ranges::find(words.parts, argument) != words.parts.end())
                run.parts.push_back(argument);
            else if (run.folder.empty() && argument.find_first_not_of("0123456789") != std::string::npos)
                run.folder = argument;
            else  // a part that does not exist, or a subject that is written wrongly
                return argument.empty() ? "(empty)" : argument;
            continue;
        }
        const std::string name = argument.substr(2);
        char* end = nullptr;
        const double value = ++i < argc ? std::strtod(argv[i], &end) : 0;
        if (!end || *end) return argument;
        if (name == "scale" && value > 0 && value <= 1)
            run.scale = value;
        else if (std::ranges::find(words.options, name) != words.options.end())
            run.options[name] = value;
        else
            return argument;
    }
    return "";
}

/// The main function of a benchmark: runs `measure` in FOLDER or in a temporary one that is removed, also by
/// a signal that ends the program. First prints circumstances(). Returns the exit status: 1 if something
/// failed, but not for a missed target.
inline int bench_main(int argc, char** argv, const std::function<Result<void>(const BenchRun&)>& measure,
                      const BenchWords& words = {}) {
    const std::string program = std::filesystem::path(argv[0]).filename();
    BenchRun run;
    if (const std::string wrong = read_arguments(argc, argv, words, run); !wrong.empty()) {
        std::string usage = program + " [FOLDER]";
        for (const std::string& subject : words.subjects) usage += fmt::format(" [{}]", subject);
        for (const std::string& part : words.parts) usage += fmt::format(" [{}]", part);
        usage += " [--scale S, of the full size, at most 1]";
        for (const std::string& option : words.options) usage += fmt::format(" [--{} NUMBER]", option);
        fmt::print(stderr, "{}: {}: is unknown or has no valid number; usage: {}\n", program, wrong, usage);
        return 2;
    }
    std::optional<TemporaryFolder> own;
    if (run.folder.empty()) {
        handle_interrupts();
        auto made = TemporaryFolder::create();
        if (!made) {
            fmt::print(stderr, "{}: {}\n", program, made.error().line());
            return 1;
        }
        run.folder = own.emplace(std::move(*made)).path();
    }
    std::filesystem::create_directories(run.folder);
    fmt::print("{}{}: {}\n", program, run.subject.empty() ? "" : " " + run.subject, circumstances());
    const auto done = measure(run);
    if (!done) fmt::print(stderr, "{}: {}\n", program, done.error().line());
    return done ? 0 : 1;
}

}  // namespace lucarne::bench
