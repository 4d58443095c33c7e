#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "io/core/interrupt.h"
#include "io/core/log.h"
#include "viewer/commands/commands.h"

int main(int argc, char** argv) {
    using namespace lucarne;
    // Writing beyond `ulimit -f` shall fail as on a full disk, with an error, instead of ending the program.
    std::signal(SIGXFSZ, SIG_IGN);
    handle_interrupts();
    CLI::App app{"Lucarne: point clouds of any size in the light of their own surfaces."};
    app.name("lucarne");
    app.require_subcommand(1);
    viewer::Command chosen;
    for (const auto add : viewer::commands()) add(app, chosen);
    const auto complain = [](const std::string& line) { std::fprintf(stderr, "lucarne: %s\n", line.c_str()); };
    try {
        app.parse(argc, argv);
        const log::Operation command;
        const log::Operation::Scope scope(command);
        if (auto done = chosen(); !done) {
            complain(done.error().line());
            return static_cast<int>(done.error().kind);
        }
        if (std::fflush(stdout) != 0) {  // what was printed is the result
            complain("output: cannot be written; look at where it is sent");
            return static_cast<int>(ErrorKind::failed);
        }
        return 0;
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help
        complain(Error{ErrorKind::arguments, "arguments", error.what(), "see lucarne --help"}.line());
        return static_cast<int>(ErrorKind::arguments);
    } catch (const std::bad_alloc&) {
        complain("memory: there is not enough; lower --memory or --points");
    } catch (const std::exception& error) {
        complain(Error{ErrorKind::failed, "internal error", error.what(), ""}.line());
    }
    return static_cast<int>(ErrorKind::failed);
}
