// Mean ranks, with bars over optimizers that the tests do not tell apart, in the manner of Demsar,
// J. 2006, Statistical comparisons of classifiers over multiple data sets, JMLR 7. Here the bars
// come from pairwise signed-rank tests with Holm's correction. The reason is that a comparison of
// two mean ranks depends on which other optimizers take part (Benavoli, A., Corani, G. and Mangili,
// F. 2016, JMLR 17(5)).
import type { EChartsOption } from '../charts/echarts';
import type { Look } from '../charts/look';
import { make_axis, make_chart, type Part } from '../charts/parts';
import type { StudyProblem } from '../data';
import type { Column, Figure, Picked, Value } from '../model';
import { format_number } from '../numbers';
import { find_pair } from './study_pairs';
import { describe_size, end_title, get_problem, make_problem_choices, type Scope, sort_by } from './study_parts';

export interface Ranks {
  ranks: number[]; // one per optimizer
  intervals: [number, number][] | null;
  cliques: number[][];
}

const kRowHeight = 19;
const kBarHeight = 8;
const kAbove = 46; // pixels above the axis
const kMargin = 212; // pixels; space for names of some thirty letters and a rank

// Returns all longest stretches, in the order of ranks, in which no two optimizers are told apart.
export function find_cliques(problem: StudyProblem, ranks: number[]): number[][] {
  const order = sort_by(
    ranks.map((_, i) => i),
    (i) => ranks[i],
  );
  const told_apart = (a: number, b: number) => {
    const pair = find_pair(problem.pairs, a, b);
    return pair !== undefined && pair.significant;
  };
  const cliques: number[][] = [];
  let reached = 0; // end of the last stretch
  for (let from = 0; from < order.length; ++from) {
    let to = from + 1;
    while (to < order.length && order.slice(from, to).every((one) => !told_apart(one, order[to]))) {
      ++to;
    }
    if (to > reached) {
      reached = to;
      if (to - from > 1) {
        cliques.push(order.slice(from, to));
      }
    }
  }
  return cliques;
}

// Returns levels for the bars, so that no two bars of a level overlap.
function stack(bars: { low: number; high: number }[]): number[] {
  const ends: number[] = [];
  return bars.map((bar) => {
    let level = 0;
    while (level < ends.length && ends[level] > bar.low - 0.15) {
      ++level;
    }
    ends[level] = bar.high;
    return level;
  });
}

function make_bars(ranks: Ranks): { low: number; high: number; members: number[]; level: number }[] {
  const bars = sort_by(
    ranks.cliques
      .filter((clique) => clique.length > 1)
      .map((clique) => {
        const members = clique.map((i) => ranks.ranks[i]).filter((rank) => isFinite(rank));
        return { low: Math.min.apply(null, members), high: Math.max.apply(null, members), members };
      })
      .filter((bar) => bar.members.length > 1),
    (bar) => bar.low,
  );
  const levels = stack(bars);
  return bars.map((bar, i) => ({ ...bar, level: levels[i] }));
}

function count_levels(ranks: Ranks): number {
  return make_bars(ranks).reduce((most, bar) => Math.max(most, bar.level + 1), 0);
}

type Drawing = { value(dimension: number): number; coord(point: number[]): number[] };
type Item = { dataIndex: number; coordSys: { x: number; y: number; width: number; height: number } };

function draw_ranks(look: Look, scope: Scope, ranks: Ranks): EChartsOption {
  const order = sort_by(
    scope.shown.filter((i) => isFinite(ranks.ranks[i])),
    (i) => ranks.ranks[i],
  );
  const count = order.length;
  const on_left = Math.ceil(count / 2);
  const bars = make_bars(ranks);
  const levels = count_levels(ranks);
  const label = (x: number, y: number, text: string, align: string, width: number): Part => ({
    type: 'text',
    style: {
      x,
      y,
      text,
      fill: look.text,
      font: '11px ' + look.font,
      textAlign: align,
      textVerticalAlign: 'middle',
      width,
      overflow: 'truncate',
    },
  });
  const leaders: Part = {
    type: 'custom',
    name: 'mean rank',
    data: order.map((o) => {
      const interval = ranks.intervals && ranks.intervals[o];
      const note =
        scope.names[o] +
        '; mean rank ' +
        format_number(ranks.ranks[o], 3) +
        (interval ? ' (' + format_number(interval[0], 3) + ' to ' + format_number(interval[1], 3) + ')' : '');
      return { value: [ranks.ranks[o], 0], note };
    }),
    encode: { x: 0, y: 1 },
    clip: false,
    renderItem: (item: Item, api: Drawing) => {
      const box = item.coordSys;
      const i = item.dataIndex;
      const left = i < on_left;
      const row = left ? i : count - 1 - i;
      const first = box.y + 14 + levels * kBarHeight;
      const room = box.height - (first - box.y) - 6;
      const step = Math.min(kRowHeight, room / Math.max(1, on_left - 0.5));
      const y = first + step * (row + 0.5);
      const x = api.coord([api.value(0), 0])[0];
      const end = left ? box.x - 8 : box.x + box.width + 8;
      const name = scope.names[order[i]];
      const rank = format_number(api.value(0), 3);
      return {
        type: 'group',
        children: [
          {
            type: 'polyline',
            shape: {
              points: [
                [x, box.y],
                [x, y],
                [end, y],
              ],
            },
            style: { stroke: look.muted, lineWidth: 1, fill: 'none' },
          },
          { type: 'circle', shape: { cx: x, cy: box.y, r: 2.6 }, style: { fill: look.accent } },
          left ? label(end - 4, y, name + '  ' + rank, 'right', box.x - 13) : label(end + 4, y, rank + '  ' + name, 'left', box.x - 13),
        ],
      };
    },
  };
  const joined: Part = {
    type: 'custom',
    name: 'bar',
    data: bars.map((bar) => ({
      value: [bar.low, bar.high],
      note:
        'Not told apart: ' +
        bar.members.length +
        ' optimizers, mean ranks ' +
        format_number(bar.low, 3) +
        ' to ' +
        format_number(bar.high, 3),
    })),
    encode: { x: [0, 1] },
    clip: false,
    z: 4,
    renderItem: (item: Item, api: Drawing) => {
      const bar = bars[item.dataIndex];
      const y = item.coordSys.y + 11 + bar.level * kBarHeight;
      const [from, to] = [api.coord([bar.low, 0])[0], api.coord([bar.high, 0])[0]];
      const children: Part[] = [
        { type: 'rect', shape: { x: from - 3, y: y - 1.8, width: to - from + 6, height: 3.6 }, style: { fill: look.text } },
      ];
      // Points mark the members of the set, because a bar may pass over other optimizers.
      bar.members.forEach((rank) =>
        children.push({
          type: 'circle',
          shape: { cx: api.coord([rank, 0])[0], cy: y, r: 2.8 },
          style: { fill: look.background, stroke: look.text, lineWidth: 1.2 },
        }),
      );
      return { type: 'group', children };
    },
  };
  const x: Part = {
    ...make_axis(look, 'x', 'mean rank (1 is best)', {}),
    position: 'top',
    min: 1,
    max: Math.max(2, scope.names.length),
    minInterval: 1,
    splitLine: { show: false },
  };
  const y: Part = { type: 'value', show: false, min: 0, max: 1 };
  return make_chart(look, x, y, [leaders, joined], {
    grid: { left: kMargin, right: kMargin, top: kAbove, bottom: 10 },
    legend: { show: false },
  });
}

function make_figure(scope: Scope, id: string, title: string, caption: string, find: (picked: Picked) => Ranks, all: Ranks[]): Figure {
  // Bars join shown optimizers only.
  const get = (picked: Picked): Ranks => {
    const ranks = find(picked);
    return { ...ranks, cliques: ranks.cliques.map((clique) => clique.filter((o) => scope.shown.indexOf(o) >= 0)) };
  };
  const levels = all.reduce((most, ranks) => Math.max(most, count_levels(ranks)), 0);
  return {
    kind: 'figure',
    id,
    title,
    caption,
    width: 'full',
    height: Math.max(170, kAbove + 14 + levels * kBarHeight + Math.ceil(scope.shown.length / 2) * kRowHeight + 20),
    draw: (look, picked) => draw_ranks(look, scope, get(picked)),
    table: (picked) => {
      const { ranks, intervals, cliques } = get(picked);
      const order = sort_by(scope.shown, (i) => ranks[i]);
      const groups = (i: number) =>
        cliques
          .map((clique, k) => (clique.indexOf(i) >= 0 ? String(k + 1) : ''))
          .filter((text) => text !== '')
          .join(' ');
      const bounds: Column[] = [
        { label: 'lower', numeric: true },
        { label: 'upper', numeric: true },
      ];
      const columns: Column[] = [{ label: 'optimizer' }, { label: 'mean rank', numeric: true }];
      return {
        columns: columns.concat(intervals ? bounds : [], [{ label: 'bars' }]),
        rows: order.map((i): Value[] => {
          const row: Value[] = [scope.names[i], isFinite(ranks[i]) ? ranks[i] : null];
          return row.concat(intervals ? intervals[i] : [], [groups(i)]);
        }),
      };
    },
  };
}

const kBars =
  "A bar joins optimizers of which the tests tell no two apart (Wilcoxon's signed-rank test, Holm's correction, 0.05). The circles on a bar are its members. ";

// The ranks over problems. Each problem counts once, by its medians.
export function make_overall_ranks(scope: Scope): Figure | null {
  const overall = scope.data.overall;
  if (!overall || scope.data.problems.length < 2) {
    return null;
  }
  const ranks: Ranks = { ranks: overall.mean_ranks, intervals: overall.rank_intervals, cliques: overall.cliques };
  const few =
    scope.data.problems.length < 6
      ? 'With fewer than six problems no difference between two optimizers can be significant. The ranks only describe these problems. '
      : 'A bar does not prove that its members are equal. ';
  const caption =
    'Critical-difference diagram of the mean ranks over ' +
    scope.data.problems.length +
    ' problems. Each problem ranks the optimizers by their medians. ' +
    kBars +
    few +
    'Mean ranks depend on the optimizers that take part. ' +
    describe_size(scope);
  return make_figure(scope, 'ranks', 'Mean ranks over problems', caption, () => ranks, [ranks]);
}

// The ranks over the replicates of each problem that has ranks. Returns null if none has.
export function make_problem_ranks(all: Scope, id: string): Figure | null {
  const scope: Scope = { ...all, problems: all.problems.filter((problem) => problem.results.some((one) => one.mean_rank !== null)) };
  if (scope.problems.length === 0) {
    return null;
  }
  const get = (problem: StudyProblem): Ranks => {
    const ranks = scope.names.map((_, i) => problem.results[i]?.mean_rank ?? NaN);
    return { ranks, intervals: null, cliques: find_cliques(problem, ranks) };
  };
  const caption =
    'Critical-difference diagram of the ranks of the runs of a replicate, averaged over the replicates. ' +
    kBars +
    'A bar does not prove that its members are equal, and mean ranks depend on the optimizers that take part. ' +
    describe_size(scope);
  const figure = make_figure(
    scope,
    id,
    end_title(scope, 'Mean ranks over replicates'),
    caption,
    (picked) => get(get_problem(scope, picked)),
    scope.problems.map(get),
  );
  figure.choices = make_problem_choices(scope);
  return figure;
}
