#include "viewer/program/program.h"

#include <cstdio>
#include <exception>
#include <new>

#include "io/core/log.h"

namespace lucarne::viewer {
namespace {

Result<void> run_command(const Program& program, int argc, char** argv) {
    CommandLine line("lucarne", "Lucarne: shows point clouds of any size with global illumination.");
    program.declare(line);
    LUCARNE_ASSIGN(const auto action, line.parse(argc, argv));
    if (!action) return {};  // the help was printed
    const log::Operation command;
    const log::Operation::Scope scope(command);
    LUCARNE_TRY(action());
    if (std::fflush(stdout) != 0)  // the printed text is the command's result
        return failed("output", "cannot be written", "check where it is redirected");
    return {};
}

Result<void> guarded_command(const Program& program, int argc, char** argv) {
    try {
        return run_command(program, argc, argv);
    } catch (const std::bad_alloc&) {
        return failed("memory", "not enough", "lower --memory or --points");
    } catch (const std::exception& error) {
        return failed("internal error", error.what());
    }
}

}  // namespace

int report(const Error& error, const std::string& who) {
    std::fprintf(stderr, "lucarne: %s%s\n", error.line().c_str(), who.c_str());
    return static_cast<int>(error.kind);
}

int run_program(const Program& program, int argc, char** argv) {
    const auto outcome = program.conclude(guarded_command(program, argc, argv));
    return outcome ? 0 : report(outcome.error(), program.who);
}

}  // namespace lucarne::viewer
