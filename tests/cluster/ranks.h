// Runs conversions on several ranks, as mpirun starts them.
#pragma once

#include <filesystem>
#include <string>

#include "tests/viewer/program.h"

namespace lucarne::test {

inline std::string mpi_program() {
    return (std::filesystem::path(LUCARNE_BINARY).parent_path() / "lucarne-mpi").string();
}

/// Returns what is missing for these tests, nothing if all is there.
inline std::string missing_for_ranks() {
    if (!installed("mpirun")) return "needs mpirun (Debian: openmpi-bin)";
    if (!std::filesystem::exists(mpi_program()))
        return "needs lucarne-mpi, which is built where MPI is installed (Debian: libopenmpi-dev)";
    return {};
}

/// The command that starts `count` copies of a program. Copies may be more than processors, and containers
/// often forbid what OpenMPI does to copy between processes. If one is killed, mpirun kills the others, which
/// get five seconds instead of one to remove their files, because the machine may be busy.
inline std::string mpirun(int count) {
    return "OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_plm_rsh_agent=/bin/false "
           "OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_odls_base_sigkill_timeout=5 mpirun --allow-run-as-root "
           "--oversubscribe --bind-to none -n " +
           std::to_string(count) + " ";
}

inline Outcome on_ranks(int count, const std::string& arguments) {
    return shell(mpirun(count) + LUCARNE_BINARY " " + arguments);
}

#define LUCARNE_NEEDS_RANKS() \
    if (const std::string missing = test::missing_for_ranks(); !missing.empty()) GTEST_SKIP() << missing

}  // namespace lucarne::test
