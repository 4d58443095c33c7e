// lucarne-mpi: `lucarne convert` on several machines. lucarne starts it when it was itself started by mpirun
// or srun (viewer/program/launched.h).
#include <csignal>
#include <memory>

#include <fmt/format.h>

#include "io/core/interrupt.h"
#include "io/core/log_silence.h"
#include "io/core/progress.h"
#include "octree/cluster/mpi_ranks.h"
#include "viewer/commands/convert.h"
#include "viewer/program/program.h"

int main(int argc, char** argv) {
    using namespace lucarne;
    std::signal(SIGXFSZ, SIG_IGN);  // as in main.cpp
    handle_interrupts();
    const auto ranks = octree::start_mpi();
    if (!ranks) return viewer::report(ranks.error());
    octree::Ranks& all = **ranks;
    if (all.rank() > 0) {  // rank 0 speaks for all, except for errors
        log::set_silent(true);
        Progress::set_silent(true);
    }
    return viewer::run_program(
        {.declare = [&](viewer::CommandLine& line) { viewer::add_convert_of(line, &all); },
         .conclude = [&](Result<void> outcome) { return all.conclude(std::move(outcome)); },
         .who = fmt::format(" (rank {} of {})", all.rank(), all.count())},
        argc, argv);
}
