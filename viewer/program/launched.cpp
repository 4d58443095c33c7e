#include "viewer/program/launched.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

namespace lucarne::viewer {
namespace {

long number_in(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? std::strtol(text, nullptr, 10) : 0;
}

/// Returns in how many copies mpirun or srun has started this program; 0 or 1 if neither did. OpenMPI's
/// mpirun, MPICH's and srun say so in the environment. SLURM_STEP_NUM_TASKS is not set in a batch script
/// itself.
long copies() {
    for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
        if (const long copies = number_in(variable); copies > 0) return copies;
    return std::getenv("SLURM_PROCID") ? number_in("SLURM_STEP_NUM_TASKS") : 0;
}

}  // namespace

Result<void> hand_over_to_ranks(int argc, char** argv) {
    const long ranks = copies();
    if (ranks < 2 || argc < 2 || std::string_view(argv[1]) != "convert") return {};
    std::error_code unknown;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", unknown);
    const auto program = self.parent_path() / "lucarne-mpi";
    ::execv(program.c_str(), argv);
    return failed("convert",
                  fmt::format("was started in {} copies by MPI, but {} cannot be run ({})", ranks,
                              program.string(), std::strerror(errno)),
                  "install lucarne-mpi, or start one lucarne without mpirun or srun");
}

}  // namespace lucarne::viewer
