// The ranks of a job that mpirun (or srun --mpi=pmix) has started, by OpenMPI's C interface. A
// program that is started otherwise, or alone, never touches MPI.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "study/executor/message_transport.hpp"

namespace armwright {

// Where this process stands among those that were started together.
struct RankPlace {
  std::size_t rank = 0;
  std::size_t size = 1;
  std::size_t on_this_machine = 1;  // ranks
  bool survives = false;            // the death of a rank does not end the others
};
// From the environment; nothing if the process was started alone.
std::optional<RankPlace> find_rank_place();

// Cores that this rank may use without getting in the way of others on its machine.
unsigned count_rank_cores(const RankPlace& place);

// Begins MPI, which all ranks must do. Error{usage} if this program was built without it.
std::unique_ptr<Links> open_mpi_links();
// Ends MPI, which only all ranks together can do: where one is missing it would wait for ever.
void close_mpi();
// Ends all ranks, those that hang as well, and this process with them.
[[noreturn]] void abort_mpi(int exit_code);

}  // namespace armwright
