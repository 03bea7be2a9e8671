"""Running times, profiles and fronts from their definitions, by other ways than the program's."""

import itertools
import math

from scipy import stats


def ert(costs, reached):
    return [math.fsum(costs) / sum(reached) if sum(reached) else math.inf]


def resampled_interval(costs, reached, options):
    """All failures cost the same, and all successes: the number of successes in a resample has the binomial
    distribution, and ERT falls with it."""
    level, resamples = options
    n = len(costs)
    success = max((c for c, r in zip(costs, reached) if r), default=0)
    failure = max((c for c, r in zip(costs, reached) if not r), default=0)
    successes = stats.binom(n, sum(reached) / n)
    result = []
    for p in ((1 + level) / 2, (1 - level) / 2):
        deviation = math.sqrt(p * (1 - p) / resamples)
        count = successes.ppf(p)
        assert successes.ppf(p - 4 * deviation) == count == successes.ppf(p + 4 * deviation)
        result.append(success + (n - count) * failure / count if count else math.inf)
    return result


def runtime_ecdf(costs, times):
    return [sum(t <= c for t in times if t < math.inf) / len(times) for c in costs]


def anytime_area(limits, times):
    """Piece by piece between the costs at which the ECDF rises."""
    low, high = limits
    edges = sorted({low, high, *(t for t in times if low < t < high)})
    pieces = [runtime_ecdf([a], times)[0] * (math.log(b) - math.log(a)) for a, b in itertools.pairwise(edges)]
    return [math.fsum(pieces) / (math.log(high) - math.log(low))]


def performance_profile(alphas, *costs):
    result = []
    for solver in range(len(costs[0])):
        for alpha in alphas:
            solved = [(row[solver], min(row)) for row in costs if row[solver] < math.inf]
            result.append(sum(c == best or 0 < c <= alpha * best for c, best in solved if best or not c) / len(costs))
    return result


def data_profile(kappas, dimensions, *costs):
    result = []
    for solver in range(len(costs[0])):
        for kappa in kappas:
            solved = [row[solver] <= kappa * (n + 1) for row, n in zip(costs, dimensions) if row[solver] < math.inf]
            result.append(sum(solved) / len(costs))
    return result


def non_dominated(*points):
    def dominates(p, q):
        return all(x <= y for x, y in zip(p, q)) and any(x < y for x, y in zip(p, q))

    return [i for i, q in enumerate(points) if not any(dominates(p, q) for p in points)]


def hypervolume(reference, *points):
    """Cell by cell of the grid of all coordinates."""
    grid = []
    for i, limit in enumerate(reference):
        edges = sorted({p[i] for p in points if p[i] < limit} | {limit})
        grid.append(list(itertools.pairwise(edges)))
    cells = []
    for cell in itertools.product(*grid):
        if any(all(x <= edge[0] for x, edge in zip(p, cell)) for p in points):
            cells.append(math.prod(b - a for a, b in cell))
    return [math.fsum(cells)]


def attainment(level, *fronts):
    """Every crossing of coordinates that enough runs attain and that no other such crossing dominates."""
    fronts = [list(zip(front[::2], front[1::2])) for front in fronts]
    points = [p for front in fronts for p in front if math.inf not in p]
    attained = []
    for x, y in itertools.product({p[0] for p in points}, {p[1] for p in points}):
        runs = sum(any(p[0] <= x and p[1] <= y for p in front) for front in fronts)
        if runs / len(fronts) >= level[0]:
            attained.append((x, y))
    corners = sorted(attained[i] for i in non_dominated(*attained))
    return [number for corner in corners for number in corner]
