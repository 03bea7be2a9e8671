"""What scipy and numpy compute of the statistics; and what they do not offer, from its definition, by
brute force or exact fractions, without a thought for speed. Every function takes lists of numbers and
returns one list."""

import itertools
import math
from fractions import Fraction

import numpy as np
from scipy import stats


def ranks(values):
    return list(stats.rankdata(values))


def quantile(p, values):
    """numpy's makes NaN of infinities, so these are put in as a number larger than all and seen again."""
    if math.inf not in values:
        return [np.quantile(values, p[0])]
    result = np.quantile([min(v, 1e250) for v in values], p[0])
    return [math.inf if result > 1e200 else result]


def spread(values):
    return [quantile([p], values)[0] for p in (0.5, 0.25, 0.75)]


def median_interval(values, options):
    """The exact bootstrap distribution of the median: over all resamples of a few values, else of an odd
    number of them from binomial probabilities. The quantiles must not depend on the draws' luck."""
    level, resamples = options
    n, ordered = len(values), sorted(values)
    if n <= 5:
        medians = [quantile([0.5], drawn)[0] for drawn in itertools.product(ordered, repeat=n)]
        weights = [(m, n**-n) for m in medians]
    else:
        assert n % 2 == 1
        # The median is at most the k-th smallest if more than half of the draws are among the k smallest.
        below = [stats.binom.sf(n // 2, n, k / n) for k in range(n + 1)]
        weights = [(ordered[k - 1], below[k] - below[k - 1]) for k in range(1, n + 1)]
    return [find_sure_quantile(weights, p, resamples) for p in ((1 - level) / 2, (1 + level) / 2)]


def find_sure_quantile(weights, p, resamples):
    deviation = math.sqrt(p * (1 - p) / resamples)
    found = set()
    for target in (p - 4 * deviation, p, p + 4 * deviation):
        total = 0
        for value, weight in sorted(weights):
            total += weight
            if total >= target:
                found.add(value)
                break
    assert len(found) == 1, (found, "choose another case: its interval depends on luck")
    return found.pop()


def signed_rank(a, b):
    pairs = [(x, y) for x, y in zip(a, b) if x != y]
    zeros, n = len(a) - len(pairs), len(pairs)
    if n == 0:
        return [0, zeros, 0, 0, 1, 1]
    # scipy makes NaN of some infinities: they become the largest difference of all.
    differences = [max(-1e250, min(x - y, 1e250)) for x, y in pairs]
    r = stats.rankdata(np.abs(differences))
    positive = sum(rank for rank, d in zip(r, differences) if d > 0)
    negative = sum(rank for rank, d in zip(r, differences) if d < 0)
    exact, tied = n <= 50, len(set(r)) < n
    if exact and tied:
        p = count_signs(r, min(positive, negative))
    else:
        mode = "exact" if exact else "approx"
        p = stats.wilcoxon(differences, zero_method="wilcox", correction=False, mode=mode).pvalue
    return [n, zeros, positive, negative, p, exact]


def count_signs(r, smaller):
    """All choices of signs, one by one; of many pairs, as the product of 1 + X^(2 rank) with X = 2^64."""
    if len(r) <= 14:
        sums = [sum(chosen) for chosen in itertools.product(*((0, rank) for rank in r))]
        return min(1, 2 * sum(s <= smaller for s in sums) / 2 ** len(r))
    product = 1
    for rank in r:
        product += product << (64 * round(2 * rank))
    ways = sum((product >> (64 * s)) % 2**64 for s in range(round(2 * smaller) + 1))
    return float(min(Fraction(1), Fraction(2 * ways, 2 ** len(r))))


def friedman(*blocks):
    """chi^2 and Iman and Davenport's F from the analysis of variance of the ranks, in fractions."""
    n, k = len(blocks), len(blocks[0])
    rows = [[Fraction(rank) for rank in stats.rankdata(block)] for block in blocks]
    means = [sum(column) / n for column in zip(*rows)]
    middle = Fraction(k + 1, 2)
    between = n * sum((m - middle) ** 2 for m in means)
    total = sum((rank - middle) ** 2 for row in rows for rank in row)
    degrees = [k - 1, (k - 1) * (n - 1)]
    if total == 0:
        return [*map(float, means), 0, k - 1, 1, 0, *degrees, 1]
    chi_squared = float(n * (k - 1) * between / total)
    p = stats.chi2.sf(chi_squared, k - 1)
    if k > 2:
        theirs = stats.friedmanchisquare(*zip(*blocks))
        assert math.isclose(theirs.statistic, chi_squared, rel_tol=1e-10, abs_tol=1e-12)
        assert math.isclose(theirs.pvalue, p, rel_tol=1e-10)
    f = math.inf if between == total else float((n - 1) * between / (total - between))
    return [*map(float, means), chi_squared, k - 1, p, f, *degrees, stats.f.sf(f, *degrees)]


def holm(p_values):
    """The closed test: a hypothesis is as significant as the least significant set of hypotheses that it is
    in, each set tested by Bonferroni's inequality."""
    everyone = range(len(p_values))
    sets = [s for size in range(1, len(p_values) + 1) for s in itertools.combinations(everyone, size)]
    bonferroni = {s: min(1, len(s) * min(p_values[i] for i in s)) for s in sets}
    return [max(p for s, p in bonferroni.items() if i in s) for i in everyone]


def a12(a, b):
    return [stats.mannwhitneyu(b, a, method="asymptotic").statistic / (len(a) * len(b))]


def kendall(a, b):
    if len(set(a)) < 2 or len(set(b)) < 2:
        return [float((len(set(a)) < 2) == (len(set(b)) < 2))]
    return [stats.kendalltau(a, b).statistic]


def ranking_stability(*rows):
    full = np.mean([stats.rankdata(row) for row in rows], axis=0)
    result = list(full)
    for left_out in range(len(rows) if len(rows) > 1 else 0):
        rest = np.mean([stats.rankdata(row) for i, row in enumerate(rows) if i != left_out], axis=0)
        leaders = [set(np.flatnonzero(mean == mean.min())) for mean in (full, rest)]
        result += kendall(list(full), list(rest)) + [float(leaders[0] != leaders[1])]
    return result
