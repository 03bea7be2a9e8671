// The ranks of a job that mpirun (or srun --mpi=pmix) has started, through OpenMPI's C interface. A
// program that was started in another way never calls MPI.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "study/executor/message_transport.hpp"

namespace armwright {

// The place of this process among the processes that were started together.
struct RankPlace {
  std::size_t rank = 0;
  std::size_t size = 1;             // number of ranks
  std::size_t on_this_machine = 1;  // number of ranks on this machine
  bool survives = false;            // the death of one rank does not end the others
};
// Reads the place from the environment. Returns nothing if the process was started alone.
std::optional<RankPlace> find_rank_place();

// Returns how many cores this rank may use without disturbing other ranks on its machine; at
// least 1.
unsigned count_rank_cores(const RankPlace& place);

// Starts MPI, which all ranks must do. Throws Error{usage} if this program was built without MPI,
// and Error{io} if MPI fails.
std::unique_ptr<MessageTransport> open_mpi_transport();
// Ends MPI. All ranks must call this: it blocks forever if one is missing.
void close_mpi();
// Ends all ranks, also ranks that hang, and this process.
[[noreturn]] void abort_mpi(int exit_code);

}  // namespace armwright
