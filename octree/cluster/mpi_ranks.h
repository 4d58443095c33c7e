#pragma once

#include <memory>

#include "octree/cluster/ranks.h"

namespace lucarne::octree {

/// Starts MPI and returns the ranks of MPI_COMM_WORLD; its destructor ends MPI. One such object a process.
/// A broken connection or a rank that is killed ends all ranks, as MPI does. No call waits inside MPI, which
/// would keep a processor busy. Errors: MPI does not allow calls from several threads.
Result<std::unique_ptr<Ranks>> start_mpi();

}  // namespace lucarne::octree
