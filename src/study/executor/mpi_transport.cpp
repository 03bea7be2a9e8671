#include "study/executor/mpi_transport.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "base/error.hpp"

#ifdef ARMWRIGHT_WITH_MPI
#include <mpi.h>

#include <limits>
#include <list>
#include <utility>
#include <vector>
#endif

namespace armwright {
namespace {

// Returns the number at the beginning of a variable: Slurm writes tasks per node as "2(x3),1".
std::optional<std::size_t> read_count(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) {
    return std::nullopt;
  }
  std::size_t value = 0;
  const std::string_view digits(text);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<RankPlace> find_rank_place() {
  auto size = read_count("OMPI_COMM_WORLD_SIZE");
  auto rank = read_count("OMPI_COMM_WORLD_RANK");
  auto local = read_count("OMPI_COMM_WORLD_LOCAL_SIZE");
  if (!size || !rank) {  // srun uses other variables; the ranks can only talk if there is PMIx
    rank = read_count("PMIX_RANK");
    size = rank ? read_count("SLURM_STEP_NUM_TASKS") : std::nullopt;
    local = read_count("SLURM_STEP_TASKS_PER_NODE");
  }
  if (!size || !rank || *size <= 1 || *rank >= *size) {
    return std::nullopt;
  }
  return RankPlace{.rank = *rank,
                   .size = *size,
                   .on_this_machine = std::max<std::size_t>(1, local.value_or(1)),
                   .survives = read_count("OMPI_MCA_orte_enable_recovery").value_or(0) > 0};
}

unsigned count_rank_cores(const RankPlace& place) {
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::size_t share = std::max<std::size_t>(1, cores / place.on_this_machine);
  cpu_set_t allowed;  // mpirun binds ranks to cores by default
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    share = std::min(share, static_cast<std::size_t>(std::max(1, CPU_COUNT(&allowed))));
  }
  return static_cast<unsigned>(share);
}

#ifdef ARMWRIGHT_WITH_MPI

namespace {

constexpr int kTag = 0;

void check(int result, const char* doing) {
  if (result != MPI_SUCCESS) {
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(result, text, &length);
    throw Error(ErrorKind::io, std::string("MPI cannot ") + doing + ": " + text);
  }
}

// Every transfer is started without waiting and tested later. A transfer from or to a rank that
// dies is never finished, and nothing waits for it.
class MpiTransport final : public MessageTransport {
 public:
  MpiTransport() {
    int provided = 0;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), "begin");
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    int rank = 0, size = 1;
    check(MPI_Comm_rank(MPI_COMM_WORLD, &rank), "tell this rank");
    check(MPI_Comm_size(MPI_COMM_WORLD, &size), "tell the number of ranks");
    rank_ = static_cast<std::size_t>(rank);
    size_ = static_cast<std::size_t>(size);
    if (provided < MPI_THREAD_SERIALIZED) {
      throw Error(ErrorKind::usage,
                  "this MPI does not allow threads; OpenMPI as Debian packages it does");
    }
  }

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }

  void send(std::size_t to, std::string message) override {
    tidy_up();
    Transfer& transfer = sending_.emplace_back();
    transfer.bytes = std::move(message);
    if (transfer.bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
        MPI_Isend(transfer.bytes.data(), static_cast<int>(transfer.bytes.size()), MPI_CHAR,
                  static_cast<int>(to), kTag, MPI_COMM_WORLD, &transfer.request) != MPI_SUCCESS) {
      sending_.pop_back();  // the message is lost, as if the rank had died
    }
  }

  std::optional<Message> receive() override {
    tidy_up();
    int has_message = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status;
    if (MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &has_message, &handle, &status) ==
            MPI_SUCCESS &&
        has_message != 0) {
      int size = 0;
      MPI_Get_count(&status, MPI_CHAR, &size);
      Transfer& transfer = receiving_.emplace_back();
      transfer.peer = static_cast<std::size_t>(status.MPI_SOURCE);
      transfer.bytes.resize(static_cast<std::size_t>(std::max(0, size)));
      MPI_Imrecv(transfer.bytes.data(), size, MPI_CHAR, &handle, &transfer.request);
    }
    for (auto transfer = receiving_.begin(); transfer != receiving_.end(); ++transfer) {
      if (has_ended(*transfer)) {
        Message message{.from = transfer->peer, .bytes = std::move(transfer->bytes)};
        receiving_.erase(transfer);
        return message;
      }
    }
    return std::nullopt;
  }

 private:
  struct Transfer {
    MPI_Request request = MPI_REQUEST_NULL;
    std::size_t peer = 0;
    std::string bytes;
  };

  static bool has_ended(Transfer& transfer) {
    int done = 0;
    return MPI_Test(&transfer.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
  }
  void tidy_up() { sending_.remove_if(has_ended); }

  std::size_t rank_ = 0;
  std::size_t size_ = 1;
  std::list<Transfer> sending_;
  std::list<Transfer> receiving_;
};

}  // namespace

std::unique_ptr<MessageTransport> open_mpi_transport() {
  return std::make_unique<MpiTransport>();
}

void close_mpi() {
  MPI_Finalize();
}

void abort_mpi(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  ::_exit(exit_code);
}

#else

std::unique_ptr<MessageTransport> open_mpi_transport() {
  throw Error(ErrorKind::usage,
              "this armwright was built without MPI and cannot share its work over ranks; "
              "install the Debian package libopenmpi-dev and build it again, or start it without "
              "mpirun");
}

void close_mpi() {}

void abort_mpi(int exit_code) {
  ::_exit(exit_code);
}

#endif

}  // namespace armwright
