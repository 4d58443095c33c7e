#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "io/core/interrupt.h"
#include "io/core/log.h"
#include "viewer/commands/commands.h"

int main(int argc, char** argv) {
    using namespace lucarne;
    // Writing beyond `ulimit -f` then fails with an error, as on a full disk, instead of ending the program.
    std::signal(SIGXFSZ, SIG_IGN);
    handle_interrupts();
    const auto complain = [](const std::string& line) {
        std::fprintf(stderr, "lucarne: %s\n", line.c_str());
    };
    const auto fail = [&](const Error& error) {
        complain(error.line());
        return static_cast<int>(error.kind);
    };
    try {
        viewer::CommandLine line("lucarne",
                                 "Lucarne: shows point clouds of any size with global illumination.");
        for (const auto add : viewer::commands()) add(line);
        const auto action = line.parse(argc, argv);
        if (!action) return fail(action.error());
        if (!*action) return 0;  // the help was printed
        const log::Operation command;
        const log::Operation::Scope scope(command);
        if (const auto done = (*action)(); !done) return fail(done.error());
        if (std::fflush(stdout) != 0) {  // the printed text is the command's result
            complain("output: cannot be written; check where it is redirected");
            return static_cast<int>(ErrorKind::failed);
        }
        return 0;
    } catch (const std::bad_alloc&) {
        complain("memory: not enough; lower --memory or --points");
    } catch (const std::exception& error) {
        complain(Error{ErrorKind::failed, "internal error", error.what(), ""}.line());
    }
    return static_cast<int>(ErrorKind::failed);
}
