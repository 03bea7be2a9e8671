"""scripts/scaling_model.py: that it follows the program's own numbers, and what must hold of any simulation."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import scaling_model as scaling  # noqa: E402

MODEL = scaling.Model(round_trip_s=1e-6, byte_s=1e-9, chunk_s=1e-6, pair_s=1e-7, wake_s=1e-4)


def find(file, pattern):
    """The number that a source file has there, the only one."""
    found = re.findall(pattern, (ROOT / "src/study/executor" / file).read_text())
    assert len(found) == 1, (file, pattern, found)
    return float(found[0].replace("'", ""))


class ScalingModelTest(unittest.TestCase):
    def test_constants_are_the_programs(self):
        for value, file, pattern, unit in (
                (scaling.CHUNK_S, "chunk_planner.cpp", r"kChunk_s = ([0-9.]+);", 1),
                (scaling.CHUNK_EACH_S, "chunk_planner.cpp", r"kChunkEach_s = ([0-9.e-]+);", 1),
                (scaling.LATEST, "chunk_planner.cpp", r"kLatest = ([0-9.]+);", 1),
                (scaling.CHUNKS_AHEAD, "chunk_planner.hpp", r"kChunksAhead = ([0-9]+);", 1),
                (scaling.MOST_RISE, "chunk_planner.cpp", r"kMostRise = ([0-9.]+);", 1),
                (scaling.SHORTEST_S, "coordinator_messages.cpp", r"kShortest\{([0-9']+)\}", 1e-6),
                (scaling.LONGEST_S, "coordinator_messages.cpp", r"kLongest\{([0-9']+)\}", 1e-6),
                (scaling.AT_ONCE, "coordinator_messages.cpp", r"kAtOnce = ([0-9]+);", 1),
                (scaling.FORGETTING_S, "chunk_planner.cpp", r"kForgetting_s = ([0-9.]+);", 1),
                (scaling.FIRST_LATENCY_S, "chunk_planner.hpp", r"double seconds_ = ([0-9.]+);", 1),
                (scaling.BUSY_PAUSE_S, "worker.cpp", r"kBusyPause\{([0-9']+)\}", 1e-6),
                (scaling.IDLE_SHORTEST_S, "worker.cpp", r"kShortest\{([0-9']+)\}", 1e-6),
                (scaling.IDLE_LONGEST_S, "worker.cpp", r"kLongest\{([0-9']+)\}", 1e-6),
                (scaling.IDLE_GROWTH, "worker.cpp", r"pause_ / ([0-9]+)", 1)):
            self.assertAlmostEqual(value, find(file, pattern) * unit, msg=f"{file}: {pattern}")

    def test_chunks_are_planned_as_the_program_does(self):
        work = scaling.Work(pairs=1000, cost_s=5e-5, granularity=8, largest=64)
        self.assertEqual(scaling.calc_share(work, 1000, 4), 128)  # an eighth, in whole loads
        self.assertEqual(scaling.calc_timely(work, 0.01, 5e-5), 200)
        self.assertEqual(scaling.plan_local_chunk(work, 1000, 4, 5e-5), 64)
        self.assertEqual(scaling.plan_remote_chunk(work, 1000, 4, 3, 5e-5, 0.05, 1, 0, 1e-3), 128)
        self.assertEqual(scaling.plan_remote_chunk(work, 1000, 4, 3, 5e-5, 0.005, 1, 0, 1e-3), 0)  # later than at home
        self.assertEqual(scaling.calc_chunk(work, 128, 2), 8)
        work = scaling.Work(pairs=100_000, cost_s=5e-3)
        self.assertEqual(scaling.plan_remote_chunk(work, 100_000, 1000, 999, 5e-3, 500, 1, 0, 1e-3), 7)  # 40 ms

    def test_one_rank_is_one_thread(self):
        result = scaling.simulate(MODEL, scaling.Team(1), scaling.Work(40, 5e-3))
        self.assertAlmostEqual(result.time_s, 0.2)
        self.assertEqual(result.chunks, 0)

    def test_nobody_is_faster_than_all_cores(self):
        for ranks, threads, cores in ((2, 1, 2), (4, 1, 2), (10, 16, 160)):
            for pairs, cost_s in ((35, 5e-5), (200, 5e-3), (1000, 5e-4)):
                result = scaling.simulate(MODEL, scaling.Team(ranks, threads, cores), scaling.Work(pairs, cost_s, batches=2))
                self.assertEqual(len(result.batches_s), 2)
                self.assertGreaterEqual(result.time_s, 2 * pairs * cost_s / min(cores, ranks * threads))
                self.assertLess(result.time_s, 2.2 * pairs * cost_s + 0.01)

    def test_large_batches_use_all_ranks(self):
        result = scaling.simulate(MODEL, scaling.Team(100), scaling.Work(10_000, 5e-3))
        self.assertLess(result.time_s, 1.02 * 0.5)

    def test_cells_share_the_ranks(self):
        work = scaling.Work(5, 5e-3, cells=12, batches=10)
        result = scaling.simulate(MODEL, scaling.Team(10), work)
        self.assertEqual(len(result.batches_s), 120)
        self.assertLess(result.time_s, 1.1 * 600 * 5e-3 / 10)

    def test_a_fit_finds_what_made_the_measurements(self):
        work, team = scaling.Work(200, 5e-5), scaling.Team(2, 1, 2)
        measured_s = scaling.predict_batch_s(MODEL, team, work)
        fitted = scaling.fit(MODEL, [None], lambda model, _: scaling.predict_batch_s(model, team, work) / measured_s - 1,
                             ("wake_s",), (3e-4,), (5e-5,))
        self.assertAlmostEqual(scaling.predict_batch_s(fitted, team, work), measured_s, delta=0.02 * measured_s)


if __name__ == "__main__":
    unittest.main()
