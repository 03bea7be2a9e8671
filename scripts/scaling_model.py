"""Simulates by discrete events how batches are distributed over ranks. It follows the policy of src/study/executor/chunk_planner.cpp and
the behaviour of coordinator_messages.cpp and worker.cpp, in simulated time.

The model has few parameters. All are times in seconds, except crowding:

    round_trip_s  an empty message there and back
    byte_s        each byte of a message, there or back
    chunk_s       processor time of the coordinator for a chunk, without MPI (encode, decode, deliver, plan)
    pair_s        the same for each pair of the chunk
    wake_s        the time from the end of a sleep until the thread works: a pause is longer than requested by this time
    wake_shared_s the same if ranks share cores, and a thread that wakes finds its core busy with another thread
    crowding      the factor by which a pair takes longer while all cores of the machine work (1: not longer)

A chunk of m pairs therefore takes chunk_s + m pair_s + round_trip_s + bytes byte_s of the coordinator's thread that communicates.
Threads that compute share the cores equally: k threads on C cores run at min(1, C / k) each."""

import collections
import dataclasses
import heapq
import itertools
import math

# chunk_planner.cpp
CHUNK_S = 0.01
CHUNK_EACH_S = 4e-5
CHUNKS_AHEAD = 2
LATEST = 0.3
# WorkerLatency in chunk_planner.hpp: the assumed time of a chunk beside its work, until it has been measured
FIRST_LATENCY_S = 1e-3
FORGETTING_S = 1.0
MOST_RISE = 4
# coordinator_messages.cpp: the pauses of the thread that communicates, and the number of messages that it takes in a row
SHORTEST_S, LONGEST_S = 50e-6, 1e-3
AT_ONCE = 256
# worker.cpp: pauses while the worker has work, and while it has none
BUSY_PAUSE_S = 1e-3
IDLE_SHORTEST_S, IDLE_LONGEST_S, IDLE_GROWTH = 100e-6, 2e-3, 64
# case_packets.cpp, for vectors of 16 variables and outcomes with 11 metrics
JOB_BYTES = 8 + 16 * 8 + 16
OUTCOME_BYTES = 1 + 8 + 8 + 1 + (8 + 11 * 8) + 8 + 8
HEAD_BYTES = 64


@dataclasses.dataclass
class Model:
    round_trip_s: float
    byte_s: float
    chunk_s: float
    pair_s: float
    wake_s: float = 60e-6
    wake_shared_s: float = 60e-6
    crowding: float = 1.0


@dataclasses.dataclass
class Team:
    ranks: int
    threads: int = 1      # per rank
    cores: float = math.inf  # for all ranks together


@dataclasses.dataclass
class Work:
    pairs: int            # per batch
    cost_s: float         # per pair
    granularity: int = 1
    largest: int = 1
    cells: int = 1        # that run at the same time, each with one batch at a time
    batches: int = 1      # per cell, one after the other
    serial_s: float = 0   # time of a cell between two batches
    pair_s: float = 0     # coordinator time per pair beyond that of the model: evaluator, journal


@dataclasses.dataclass
class Outcome:
    time_s: float         # until all batches have ended
    chunks: int           # sent to workers
    busy_s: float         # busy time of the thread that communicates
    batches_s: list       # time of each batch, in the order in which they ended


def round_up(pairs, granularity):
    return -(-pairs // granularity) * granularity


def calc_share(work, left, threads):
    return max(work.granularity, round_up(-(-left // (2 * threads)), work.granularity))


def calc_timely(work, chunk_s, cost_s):
    return max(1, int(chunk_s / max(cost_s, 1e-9) / work.granularity)) * work.granularity


def plan_local_chunk(work, left, threads, cost_s):
    if threads <= 1:
        return min(left, work.largest)
    most = min(max(work.largest, work.granularity), calc_timely(work, CHUNK_S, cost_s))
    return min(left, calc_share(work, left, threads), most)


def plan_remote_chunk(work, left, threads, workers, cost_s, left_here_s, worker_threads, busy_s, latency_s):
    most = min(calc_share(work, left, threads), calc_timely(work, max(CHUNK_S, CHUNK_EACH_S * workers), cost_s))
    pairs = min(left, most * worker_threads)
    a_thread = -(-pairs // worker_threads)
    return pairs if busy_s + latency_s + a_thread * cost_s <= left_here_s else 0


def calc_chunk(work, jobs, threads):
    """base/batch_size.cpp"""
    if threads <= 1:
        return work.largest
    whole = round_up(-(-jobs // (8 * threads)), work.granularity)
    return min(max(whole, work.granularity), max(work.granularity, work.largest))


class Batch:
    def __init__(self, cell, pairs, start_s):
        self.cell, self.untaken, self.missing, self.start_s = cell, pairs, pairs, start_s


class Worker:
    def __init__(self, latency_s):
        self.chunks = 0          # that it has not answered, as the coordinator sees it
        self.free_at = 0.0
        self.latency_s = latency_s
        self.heard_at = 0.0      # time of its last outcomes
        self.idle_threads = 0
        self.inbox = []          # chunks that have arrived but were not read yet
        self.pieces = []         # parts of chunks that have begun: [chunk, pairs]
        self.idle_since = 0.0


class Simulation:
    """A simulation of one team that works on one kind of batches.

    Events are (time, order, function). Work is counted in the time that one thread alone would need. All threads that compute
    progress at the same rate at any moment, so the thread with the least work left ends next."""

    def __init__(self, model, team, work, latency_s=FIRST_LATENCY_S):
        self.model, self.team, self.work = model, team, work
        self.wake_s = model.wake_s if team.ranks <= team.cores else model.wake_shared_s
        self.now, self.order = 0.0, itertools.count()
        self.events = []
        self.computing, self.computed_s = [], 0.0
        self.threads = team.ranks * team.threads
        shared = max(1.0, min(self.threads, team.ranks) / team.cores)
        self.cost_s = work.cost_s * shared
        self.workers = [Worker(latency_s) for _ in range(team.ranks - 1)]
        for worker in self.workers:
            worker.idle_threads = team.threads
        self.hungry = set(range(len(self.workers)))
        self.batches = []
        self.idle_here = team.threads
        self.busy_until = []     # times at which the local threads become free
        self.asleep = True       # whether the thread that communicates sleeps
        self.turn_due = False
        self.arrived = collections.deque()  # answers that the coordinator has not read yet
        self.chunks, self.busy_s, self.batches_s = 0, 0.0, []
        self.left_batches = work.cells * work.batches

    # Time.
    def at(self, when, function, *arguments):
        heapq.heappush(self.events, (when, next(self.order), function, arguments))

    def calc_rate(self):
        count = len(self.computing)
        rate = min(1.0, self.team.cores / count)
        if self.team.cores < math.inf and count >= self.team.cores:
            rate /= self.model.crowding
        return rate

    def compute(self, seconds, function, *arguments):
        heapq.heappush(self.computing, (self.computed_s + seconds, next(self.order), function, arguments))

    def run(self):
        for cell in range(self.work.cells):
            self.submit(cell)
        while self.left_batches:
            event_s = self.events[0][0] if self.events else math.inf
            if self.computing:
                rate = self.calc_rate()
                end_s = self.now + (self.computing[0][0] - self.computed_s) / rate
                if end_s <= event_s:
                    self.now = end_s
                    self.computed_s, _, function, arguments = heapq.heappop(self.computing)
                    function(*arguments)
                    continue
                self.computed_s += (event_s - self.now) * rate
            self.now = event_s
            _, _, function, arguments = heapq.heappop(self.events)
            function(*arguments)
        return Outcome(self.now, self.chunks, self.busy_s, self.batches_s)

    # The batches and the local threads of the coordinator.
    def submit(self, cell):
        self.batches.append(Batch(cell, self.work.pairs, self.now))
        self.work_here()
        if self.asleep and not self.turn_due:
            self.turn_due = True
            self.at(self.now + self.wake_s, self.turn)

    def work_here(self):
        for batch in self.batches:
            while self.idle_here and batch.untaken:
                pairs = plan_local_chunk(self.work, batch.untaken, self.threads, self.cost_s)
                batch.untaken -= pairs
                self.idle_here -= 1
                until = self.now + pairs * self.cost_s
                self.busy_until.append(until)
                self.compute(pairs * self.work.cost_s, self.end_here, batch, pairs, self.now, until)

    def end_here(self, batch, pairs, start_s, until):
        self.busy_until.remove(until)
        self.learn((self.now - start_s) / pairs)
        self.idle_here += 1
        self.deliver(batch, pairs, 0)
        self.work_here()

    def learn(self, latest_s):
        self.cost_s = (1 - LATEST) * self.cost_s + LATEST * latest_s

    def deliver(self, batch, pairs, wake_s):
        batch.missing -= pairs
        if batch.missing == 0:
            self.batches.remove(batch)
            self.at(self.now + wake_s, self.end_batch, batch)

    def end_batch(self, batch):
        self.left_batches -= 1
        self.batches_s.append(self.now - batch.start_s)
        if self.left_batches >= self.work.cells:
            self.at(self.now + self.work.serial_s, self.submit, batch.cell)

    # The thread of the coordinator that communicates: it assigns, sends, takes the messages that have arrived, and sleeps if there were none.
    def turn(self):
        self.turn_due = False
        self.asleep = False
        self.assign()
        start_s, taken = self.now, 0
        busy_s = self.sent_s
        while self.arrived and taken < AT_ONCE:
            _, chunk = self.arrived.popleft()
            busy_s += self.calc_receive_s(chunk[1])
            self.at(start_s + busy_s, self.take_outcomes, chunk)
            taken += 1
        self.busy_s += busy_s
        self.at(start_s + busy_s, self.end_turn, taken > 0)

    def end_turn(self, has_news):
        if has_news or self.arrived:
            self.turn()
        else:
            self.asleep = True

    def calc_send_s(self, pairs):
        return self.model.round_trip_s / 2 + (HEAD_BYTES + pairs * JOB_BYTES) * self.model.byte_s + (self.model.chunk_s + pairs * self.model.pair_s) / 2

    def calc_receive_s(self, pairs):
        return (self.model.round_trip_s / 2 + (HEAD_BYTES + pairs * OUTCOME_BYTES) * self.model.byte_s
                + (self.model.chunk_s + pairs * self.model.pair_s) / 2 + pairs * self.work.pair_s)

    def calc_left_here_s(self):
        until_free_s = 0 if self.idle_here else max(0.0, min(self.busy_until) - self.now)
        left = sum(batch.untaken for batch in self.batches)
        return max(left / self.team.threads, 1) * self.cost_s + until_free_s if left else 0.0

    def assign(self):
        self.sent_s = 0.0
        left_here_s = self.calc_left_here_s()
        for _ in range(CHUNKS_AHEAD):
            for rank in sorted(self.hungry):
                if left_here_s == 0:
                    return
                worker = self.workers[rank]
                worker.free_at = max(worker.free_at, self.now)
                unused_s = 0 if worker.chunks else self.now - worker.heard_at
                sent = self.assign_to(rank, worker, left_here_s, worker.latency_s / (1 + unused_s / FORGETTING_S))
                if sent:
                    left_here_s = self.calc_left_here_s()
                elif worker.chunks == 0:
                    break  # if an idle worker would be too late, all others would be too

    def assign_to(self, rank, worker, left_here_s, latency_s):
        for batch in self.batches:
            if batch.untaken == 0:
                continue
            pairs = plan_remote_chunk(self.work, batch.untaken, self.threads, len(self.workers), self.cost_s, left_here_s,
                                      self.team.threads, worker.free_at - self.now, latency_s)
            if pairs == 0:
                continue
            batch.untaken -= pairs
            self.sent_s += self.calc_send_s(pairs)
            self.chunks += 1
            was_idle = worker.chunks == 0
            worker.chunks += 1
            if worker.chunks == CHUNKS_AHEAD:
                self.hungry.discard(rank)
            worker.free_at += pairs * self.cost_s / self.team.threads + (worker.latency_s if was_idle else 0)
            chunk = [rank, pairs, pairs, batch, self.now, was_idle, 0.0]
            self.at(self.now + self.sent_s, self.arrive, chunk)
            return True
        return False

    def take_outcomes(self, chunk):
        rank, pairs, _, batch, sent_at, was_idle, busy_s = chunk
        worker = self.workers[rank]
        worker.chunks -= 1
        worker.heard_at = self.now
        self.hungry.add(rank)
        if worker.chunks == 0:
            worker.free_at = self.now
        if was_idle:
            latency_s = max(0.0, self.now - sent_at - busy_s / self.team.threads)
            worker.latency_s += LATEST * (min(latency_s, MOST_RISE * worker.latency_s) - worker.latency_s)
        self.learn(busy_s / pairs)
        self.deliver(batch, pairs, self.wake_s)

    # A worker: one thread reads messages, the others compute.
    def arrive(self, chunk):
        worker = self.workers[chunk[0]]
        worker.inbox.append(chunk)
        if worker.idle_threads < self.team.threads:
            pause_s = BUSY_PAUSE_S
        else:
            pause_s = min(IDLE_LONGEST_S, IDLE_SHORTEST_S + (self.now - worker.idle_since) / IDLE_GROWTH)
        self.at(self.now + (pause_s + self.wake_s) / 2, self.look, worker)

    def look(self, worker):
        for chunk in worker.inbox:
            at_once = calc_chunk(self.work, chunk[1], self.team.threads)
            worker.pieces += [[chunk, min(at_once, chunk[1] - first)] for first in range(0, chunk[1], at_once)]
        if worker.inbox:
            worker.inbox = []
            if worker.idle_threads == self.team.threads:
                self.at(self.now + self.wake_s, self.begin, worker)
            else:
                self.begin(worker)

    def begin(self, worker):
        while worker.idle_threads and worker.pieces:
            chunk, pairs = worker.pieces.pop(0)
            worker.idle_threads -= 1
            self.compute(pairs * self.work.cost_s, self.end_piece, worker, chunk, pairs, self.now)

    def end_piece(self, worker, chunk, pairs, start_s):
        chunk[6] += self.now - start_s
        chunk[2] -= pairs
        worker.idle_threads += 1
        if chunk[2] == 0:
            self.at(self.now + self.wake_s / 2, self.answer, chunk)
            self.look(worker)
        self.begin(worker)
        worker.idle_since = self.now

    def answer(self, chunk):
        self.arrived.append((self.now, chunk))
        if self.asleep and not self.turn_due:
            self.turn_due = True
            self.at(self.now + (self.calc_pause() + self.wake_s) / 2, self.turn)

    def calc_pause(self):
        if len(self.workers) > 16:
            return SHORTEST_S  # with so many workers an answer is always expected
        pauses = [(worker.free_at - self.now) / (4 * worker.chunks) for worker in self.workers if worker.chunks]
        return min(LONGEST_S, max(SHORTEST_S, min(pauses, default=SHORTEST_S)))


def simulate(model, team, work):
    return Simulation(model, team, work).run()


def predict_batch_s(model, team, work):
    """Returns the mean time of a batch as mpi_benchmark measures it: after other batches, from which the delays of the workers are known,
    and by turns of at least 40 ms with the same batch on one thread."""
    if team.ranks == 1:
        return work.pairs * work.cost_s
    learning = Simulation(model, team, Work(400, 5e-4, batches=3))
    learning.run()
    latency_s = sum(worker.latency_s for worker in learning.workers) / len(learning.workers)
    one_s = work.pairs * work.cost_s
    in_a_turn = max(1, int(0.04 / one_s))
    times_s = []
    # A turn begins after a pause. The measured delays of the workers are kept.
    for _ in range(3 if in_a_turn == 1 else 1):
        turn = Simulation(model, team, dataclasses.replace(work, batches=in_a_turn), latency_s)
        for worker in turn.workers:
            worker.idle_since = -in_a_turn * one_s
        times_s += turn.run().batches_s
        latency_s = sum(worker.latency_s for worker in turn.workers) / len(turn.workers)
    return sum(times_s) / len(times_s)


def fit(model, rows, calc_error, names, start, spans):
    """Returns the model whose parameters `names` minimise the sum of the squares of calc_error(model, row). The search goes along the axes
    with steps that are halved. It suits a few parameters and a few rows."""
    values, steps = list(start), list(spans)

    def calc(candidate):
        tried = dataclasses.replace(model, **dict(zip(names, candidate)))
        return sum(calc_error(tried, row) ** 2 for row in rows)

    best = calc(values)
    for _ in range(8):
        improved = True
        while improved:
            improved = False
            for index in range(len(values)):
                for sign in (1, -1):
                    candidate = list(values)
                    candidate[index] = candidate[index] + sign * steps[index]
                    if candidate[index] <= 0:
                        continue
                    error = calc(candidate)
                    if error < best:
                        best, values, improved = error, candidate, True
        steps = [step / 2 for step in steps]
    return dataclasses.replace(model, **dict(zip(names, values)))
