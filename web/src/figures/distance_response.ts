// The average error of the moves of each length (Fig. 5.9, 5.11, 6.4, 6.9-6.15 of the thesis).
import { get_series_style } from '../charts/look';
import { make_number_axis, make_plot } from '../charts/marks';
import { shorten_all } from '../charts/names';
import { make_error_bars, make_line, type Part, type Point } from '../charts/parts';
import type { DistanceResponse, ResponseSeries } from '../data';
import type { Choice, Column, Figure, Value } from '../model';
import { format_number, kMillimetres } from '../numbers';
import { are_positive, count_of, find_range, flatten, times } from './quantities';

const kCentimetres = 100;
const kStacked = 8; // with more series the legend would leave no room for the curves
const kWide = 5; // ratio of the largest to the smallest distance from which the axis is logarithmic

export function make_scale_choice(initial: 'log' | 'linear'): Choice {
  return {
    id: 'scale',
    label: 'scale',
    options: [
      { value: 'log', label: 'logarithmic' },
      { value: 'linear', label: 'linear' },
    ],
    initial,
  };
}

// Returns the names of the series, such as "Complex: 5.75 mm, published 5.8 mm".
function name_series(response: DistanceResponse): string[] {
  return shorten_all(response.series.map((one) => one.name)).map((name, i) => {
    const { overall_mean_m, published_mean_m } = response.series[i];
    const ours = overall_mean_m === null ? 'no mean' : `${format_number(overall_mean_m * kMillimetres, 3)} mm`;
    const published = published_mean_m === null ? '' : ` (published ${Number((published_mean_m * kMillimetres).toPrecision(3))})`;
    return `${name}: ${ours}${published}`;
  });
}

function describe(response: DistanceResponse): string {
  const numbers = response.series.map((one) => one.cases);
  const same = numbers.every((one) => one === numbers[0]);
  const failures = response.series.filter((one) => one.failures > 0);
  const left_out = response.counted.filter((one) => !one).length;
  const has_published = response.series.some((one) => one.published_mean_m !== null);
  return (
    `The average positional error of the moves of each length, ` +
    `over ${same ? count_of(numbers[0] ?? 0, 'test case') : `${numbers.join(', ')} test cases, in the order of the legend`}; ` +
    `the bars show the standard error of the mean. ` +
    (left_out > 0 ? `A hollow point is a move that does not count in the error of a case. ` : '') +
    `The legend has the mean over all moves that count${has_published ? ' and the value that the thesis printed' : ''}. ` +
    (failures.length > 0 ? `Failed cases: ${failures.map((one) => `${shorten_all([one.name])[0]} ${one.failures}`).join(', ')}. ` : '') +
    response.remark
  ).trim();
}

export function make_response_figure(response: DistanceResponse, id = response.id): Figure {
  const names = name_series(response);
  const positive = are_positive(flatten(response.series.map((one) => one.mean_m)));
  const distances = response.distances_m.map((one) => one * kCentimetres);
  const extent = find_range(distances);
  const wide = are_positive(distances) && extent !== null && extent[1] > kWide * extent[0];
  const order = distances.map((_, i) => i).sort((a, b) => distances[a] - distances[b]);
  return {
    kind: 'figure',
    id,
    title: response.title,
    caption: describe(response),
    thesis: response.thesis || undefined,
    height: 400,
    choices: positive ? [make_scale_choice('log')] : undefined,
    draw: (look, picked) => {
      const log = positive && picked.scale !== 'linear';
      const series: Part[] = [];
      const values = flatten(response.series.map((one) => flatten(make_bars(one, distances, log).map((bar) => [bar[1], bar[2]]))));
      response.series.forEach((one, s) => {
        const style = get_series_style(look, s);
        const point = (i: number): Point => ({
          value: [distances[i], times(one.mean_m[i], kMillimetres)],
          command: one.command || undefined,
          note: note_of(response, one, i),
        });
        const on = order.filter((i) => response.counted[i]).map(point);
        const off = order.filter((i) => !response.counted[i]).map(point);
        series.push(make_line(look, s, names[s], on, { symbols: true, on_top: s === 0 }));
        if (off.length > 0) {
          series.push({
            type: 'scatter',
            name: names[s],
            data: off,
            symbol: style.symbol.replace('empty', ''),
            symbolSize: 7,
            itemStyle: { color: look.background, borderColor: style.color, borderWidth: 1.6 },
          });
        }
        series.push(make_error_bars(names[s], make_bars(one, distances, log), style.color));
      });
      const stacked = names.length <= kStacked;
      return make_plot(
        look,
        make_number_axis(look, 'x', 'distance of the move (cm)', { log: wide, values: distances }),
        make_number_axis(look, 'y', 'average positional error (mm)', { log, min: log ? undefined : 0, values }),
        series,
        {
          grid: { left: 68, right: 24, top: stacked ? 18 + 18 * names.length : 44, bottom: 48 },
          ...(stacked ? { legend: make_legend_column(look.text, look.font, look.muted, names) } : {}),
        },
      );
    },
    table: () => ({
      columns: [
        { label: 'point', numeric: true },
        { label: 'distance', unit: 'cm', numeric: true },
        { label: 'counts' },
        ...flatten(
          response.series.map((one): Column[] => [
            { label: `${one.name}, mean`, unit: 'mm', numeric: true },
            { label: `${one.name}, standard error`, unit: 'mm', numeric: true },
          ]),
        ),
      ],
      rows: response.distances_m.map((distance, i) => [
        (i + 1) as Value,
        distance * kCentimetres,
        response.counted[i] ? 'yes' : 'no',
        ...flatten(response.series.map((one) => [times(one.mean_m[i], kMillimetres), times(one.standard_error_m[i], kMillimetres)])),
      ]),
    }),
  };
}

// Returns a legend with one entry per line. With their means, the entries are too long for a common
// line.
export function make_legend_column(text: string, font: string, inactive: string, names: string[]): Part {
  return {
    top: 4,
    left: 64,
    right: 16,
    orient: 'vertical',
    itemGap: 6,
    itemWidth: 24,
    itemHeight: 10,
    data: names,
    textStyle: { color: text, fontFamily: font, fontSize: 12, lineHeight: 12 },
    inactiveColor: inactive,
  };
}

function note_of(response: DistanceResponse, one: ResponseSeries, i: number): string {
  return (
    `Move ${i + 1}, ${format_number(response.distances_m[i] * kCentimetres, 3)} cm: ` +
    `${format_number(times(one.mean_m[i], kMillimetres))} ± ${format_number(times(one.standard_error_m[i], kMillimetres), 2)} mm ` +
    `over ${count_of(one.cases, 'case')}${response.counted[i] ? '' : '; does not count'}.`
  );
}

// Returns the error bars. On a logarithmic axis, a bar that reaches below zero has no lower half.
function make_bars(one: ResponseSeries, distances: number[], log: boolean): [number, number, number][] {
  const bars: [number, number, number][] = [];
  one.mean_m.forEach((mean, i) => {
    const error = one.standard_error_m[i];
    if (typeof mean === 'number' && typeof error === 'number') {
      const low = log && error >= mean ? mean : mean - error;
      bars.push([distances[i], low * kMillimetres, (mean + error) * kMillimetres]);
    }
  });
  return bars;
}
