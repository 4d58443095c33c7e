#include <csignal>

#include "io/core/interrupt.h"
#include "viewer/commands/commands.h"
#include "viewer/program/launched.h"
#include "viewer/program/program.h"

int main(int argc, char** argv) {
    using namespace lucarne;
    if (const auto handed_over = viewer::hand_over_to_ranks(argc, argv); !handed_over)
        return viewer::report(handed_over.error());
    // Writing beyond `ulimit -f` then fails with an error, as on a full disk, instead of ending the program.
    std::signal(SIGXFSZ, SIG_IGN);
    handle_interrupts();
    const auto declare = [](viewer::CommandLine& line) { viewer::add_commands(line); };
    return viewer::run_program({.declare = declare}, argc, argv);
}
