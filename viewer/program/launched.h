#pragma once

#include "io/core/error.h"

namespace lucarne::viewer {

/// If mpirun or srun has started several copies of `lucarne convert`, runs lucarne-mpi in place of this
/// program, which then does not return. lucarne-mpi is beside this program; only it needs MPI. Returns
/// otherwise. Errors: lucarne-mpi is not installed.
Result<void> hand_over_to_ranks(int argc, char** argv);

}  // namespace lucarne::viewer
