"""The inputs: random ones and nasty ones (ties, constants, single values, infinities, large and small
numbers). Yields (function, what is special, arguments)."""

import math
import random

INF = math.inf


def make_cases():
    draw = random.Random(20220101)

    def normal(n, shift=0.0):
        return [draw.gauss(shift, 1) for _ in range(n)]

    def coarse(n, levels=4):
        return [float(draw.randrange(levels)) for _ in range(n)]

    def failing(n, share=0.3):
        return [INF if draw.random() < share else draw.lognormvariate(0, 3) for _ in range(n)]

    lists = {
        "random": normal(15),
        "two": normal(2),
        "one": [3.25],
        "ties": coarse(20),
        "constant": [0.1] * 7,
        "infinities": failing(16),
        "half infinite": [1.0, INF, 2.0, INF],
        "all infinite": [INF] * 5,
        "sizes": [10.0**e for e in range(-300, 301, 60)],
        "signs": [-2.5, 0.0, -0.0, 2.5, -1e-300, 1e-300],
    }
    for name, values in lists.items():
        yield "ranks", name, [values]
        yield "spread", name, [values]
        for p in (0.0, 0.05, 0.5, 0.9, 1.0):
            yield "quantile", f"{name}, {p}", [[p], values]

    for n in (2, 3, 4, 5, 9, 17, 31):
        yield "median_interval", f"random {n}", [normal(n), [0.95, 20000]]
    yield "median_interval", "90 %", [normal(15), [0.9, 20000]]
    yield "median_interval", "one", [[2.5], [0.95, 1000]]
    yield "median_interval", "constant", [[2.5] * 9, [0.95, 1000]]
    yield "median_interval", "some infinite", [normal(9) + [INF] * 4, [0.95, 20000]]
    yield "median_interval", "infinite", [[INF] * 5, [0.95, 1000]]

    for n in (1, 2, 5, 6, 10, 15, 30, 49, 50, 51, 80, 200):
        yield "signed_rank", f"random {n}", [normal(n), normal(n, 0.4)]
        yield "signed_rank", f"ties and zeros {n}", [coarse(n, 5), coarse(n, 6)]
    yield "signed_rank", "far apart 40", [normal(40), normal(40, 9)]
    yield "signed_rank", "far apart 300", [normal(300), normal(300, 9)]
    yield "signed_rank", "all equal", [[1.5] * 6, [1.5] * 6]
    yield "signed_rank", "all equal and infinite", [[INF] * 3, [INF] * 3]
    yield "signed_rank", "same difference", [[float(i) for i in range(12)], [i + 1.0 for i in range(12)]]
    yield "signed_rank", "same difference 60", [[float(i) for i in range(60)], [i + 1.0 for i in range(60)]]
    yield "signed_rank", "infinities 12", [failing(12), failing(12)]
    yield "signed_rank", "infinities 45", [failing(45), failing(45, 0.1)]
    yield "signed_rank", "infinities 90", [failing(90), failing(90, 0.1)]
    yield "signed_rank", "infinite against all", [normal(8), [INF] * 8]

    for n, k in ((2, 2), (3, 2), (2, 3), (5, 3), (15, 4), (12, 12), (40, 7)):
        yield "friedman", f"random {n} x {k}", [normal(k) for _ in range(n)]
        yield "friedman", f"ties {n} x {k}", [coarse(k, 3) for _ in range(n - 1)] + [list(map(float, range(k)))]
    yield "friedman", "infinities", [failing(5) for _ in range(9)]
    yield "friedman", "agreement", [[i + 0.1 * j for j in range(4)] for i in range(6)]
    yield "friedman", "agreement with ties", [[1.0, 1.0, 2.0, INF]] * 5
    yield "friedman", "all tied", [[float(i)] * 3 for i in range(4)]
    yield "friedman", "almost agreement", [[1.0, 2.0, 3.0, 4.0]] * 29 + [[2.0, 1.0, 3.0, 4.0]]

    for n in (1, 2, 5, 10):
        yield "holm", f"random {n}", [[draw.random() ** 4 for _ in range(n)]]
    yield "holm", "ties, 0 and 1", [[0.01, 0.0, 0.01, 1.0, 0.01, 0.4, 0.4]]
    yield "holm", "tiny", [[1e-300, 1e-12, 2e-12, 0.9, 3e-17]]

    for n, m in ((1, 1), (15, 15), (7, 30)):
        yield "a12", f"random {n}, {m}", [normal(n), normal(m, 0.5)]
        yield "a12", f"ties {n}, {m}", [coarse(n), coarse(m)]
        yield "a12", f"infinities {n}, {m}", [failing(n), failing(m)]
    yield "a12", "apart", [normal(5), normal(9, 50)]

    for n in (2, 5, 12, 40):
        yield "kendall", f"random {n}", [normal(n), normal(n)]
        yield "kendall", f"ties {n}", [[0.0] + coarse(n - 2) + [9.0], coarse(n - 1) + [7.0]]
    yield "kendall", "reverse", [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0]]
    yield "kendall", "one constant", [[1.0, 1.0, 1.0], [3.0, 2.0, 1.0]]
    yield "kendall", "both constant", [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]
    for problems, optimizers in ((1, 3), (2, 2), (3, 12), (10, 5)):
        yield "ranking_stability", f"{problems} x {optimizers}", [normal(optimizers) for _ in range(problems)]
        yield "ranking_stability", f"ties {problems} x {optimizers}", [coarse(optimizers) for _ in range(problems)]

    spent = [draw.uniform(1, 1000) for _ in range(15)]
    yield "ert", "random", [spent, [float(i % 3 == 0) for i in range(15)]]
    yield "ert", "all", [spent, [1.0] * 15]
    yield "ert", "none", [spent, [0.0] * 15]
    sure = ((15, 5, 0.95), (15, 1, 0.7), (12, 11, 0.98), (40, 13, 0.8), (2, 1, 0.99))
    for n, successes, level in sure:  # other levels lie where the draws' luck would show
        reached = [float(i < successes) for i in range(n)]
        costs = [70.0 if r else 1000.0 for r in reached]
        yield "resampled_interval", f"{successes} of {n}", [costs, reached, [level, 100000]]
    yield "resampled_interval", "all", [[70.0] * 4, [1.0] * 4, [0.95, 1000]]
    yield "resampled_interval", "none", [[70.0] * 4, [0.0] * 4, [0.95, 1000]]
    times = [INF if draw.random() < 0.3 else float(draw.randrange(1, 2000)) for _ in range(60)]
    yield "runtime_ecdf", "random", [[0.0, 1.0, 10.0, 100.0, times[0], 1000.0, INF], times]
    yield "runtime_ecdf", "never", [[0.0, 1.0, INF], [INF] * 3]
    yield "anytime_area", "random", [[10.0, 1000.0], times]
    yield "anytime_area", "ends", [[10.0, 1000.0], [0.0, 10.0, 1000.0, 1001.0, INF, 50.0]]
    table = [[float(draw.choice([INF, 0, *range(1, 400)])) for _ in range(4)] for _ in range(20)]
    table += [[INF] * 4, [5.0] * 4, [0.0, 0.0, 3.0, INF]]
    yield "performance_profile", "random", [[1.0, 1.5, 2.0, 8.0, 1e9, INF], *table]
    dimensions = [float(draw.randrange(1, 40)) for _ in table]
    yield "data_profile", "random", [[0.0, 1.0, 5.0, 50.0, 1e9, INF], dimensions, *table]

    for n, m in ((1, 1), (6, 1), (30, 2), (10, 3), (7, 4), (5, 5)):
        points = [[draw.random() for _ in range(m)] for _ in range(n)]
        yield "hypervolume", f"random {n} in {m}", [[0.9] * m, *points]
        yield "non_dominated", f"random {n} in {m}", points
        points = [coarse(m, 5) for _ in range(n)]
        yield "hypervolume", f"ties {n} in {m}", [[4.0] * m, *points, *points[:2]]
        yield "non_dominated", f"ties {n} in {m}", [*points, *points[:2]]
    yield "hypervolume", "infinities", [[2.0, 3.0], [INF, 0.0], [0.0, INF], [1.0, 2.0], [2.0, 0.0]]
    yield "non_dominated", "infinities", [[INF, 0.0], [INF, INF], [INF, 1.0], [1.0, 2.0], [1.0, INF]]
    for level in (0.25, 0.5, 0.75, 1.0):
        yield "attainment", f"random {level}", [[level], *([draw.random() for _ in range(10)] for _ in range(7))]
        yield "attainment", f"ties {level}", [[level], *(coarse(8, 6) for _ in range(4)), [], [INF, 1.0]]
