// The error against a parameter of the task (Fig. 6.16 of the thesis: the nominal average speed).
import { get_series_style } from '../charts/look';
import { make_number_axis, make_plot, make_vertical } from '../charts/marks';
import { shorten, shorten_all } from '../charts/names';
import { make_error_bars, make_line, type Part, type Point } from '../charts/parts';
import type { Sweep } from '../data';
import type { Cell, Column, Figure } from '../model';
import { format_number, kMillimetres } from '../numbers';
import { are_positive, count_of, flatten, is_number, name_axis, times } from './quantities';

export function make_sweep_figure(sweep: Sweep, id = 'speed-sweep', thesis = ''): Figure {
  const shown_name = shorten(sweep.quantity.name);
  const names = shorten_all(sweep.series.map((one) => one.name));
  const some_fail = sweep.series.some((one) => one.failures.some((count) => count > 0));
  const values = flatten(sweep.series.map((one) => one.mean_m)).map((value) => times(value, kMillimetres));
  const log = are_positive(values);
  return {
    kind: 'figure',
    id,
    title: `Error against ${shown_name}`,
    caption:
      `The average positional error over ${count_of(sweep.cases, 'test case')}, simulated by ${sweep.engine}, with ${sweep.parameter} set to each value. ` +
      `The bars show the standard error of the mean. ` +
      (log ? 'The vertical axis is logarithmic. ' : '') +
      (sweep.nominal !== null ? 'The dashed line is the value for which the design was tuned. ' : '') +
      (some_fail ? 'At a cross, cases failed; the mean is that of all cases with a number. ' : 'No case failed. ') +
      `A design that was tuned for one value should work below it, and fails at some higher value.`,
    thesis: thesis || undefined,
    height: 360,
    draw: (look) => {
      const series: Part[] = [];
      sweep.series.forEach((one, s) => {
        const style = get_series_style(look, s);
        const points = sweep.values.map((x, i): Point => ({
          value: [x, times(one.mean_m[i], kMillimetres)],
          command: sweep.command || undefined,
          note:
            `${sweep.parameter} = ${format_number(x)}: mean ${format_number(times(one.mean_m[i], kMillimetres))} mm, ` +
            `median ${format_number(times(one.median_m[i], kMillimetres))} mm, ${count_of(one.failures[i] ?? 0, 'failure')}.`,
        }));
        series.push(make_line(look, s, names[s], points, { symbols: true, on_top: s === 0 }));
        const failed = points.filter((_, i) => one.failures[i] > 0);
        if (failed.length > 0) {
          series.push({
            type: 'scatter',
            name: names[s],
            data: failed,
            symbol: 'path://M0,0L8,8M8,0L0,8',
            symbolSize: 13,
            itemStyle: { color: look.bad, borderColor: look.bad, borderWidth: 2 },
            z: 4,
          });
        }
        const bars: [number, number, number][] = [];
        sweep.values.forEach((x, i) => {
          const mean = one.mean_m[i];
          const error = one.standard_error_m[i];
          if (is_number(mean) && is_number(error)) {
            bars.push([x, (log && error >= mean ? mean : mean - error) * kMillimetres, (mean + error) * kMillimetres]);
          }
        });
        series.push(make_error_bars(names[s], bars, style.color));
      });
      if (sweep.nominal !== null) {
        series.push(make_vertical(look, sweep.nominal, 'tuned for'));
      }
      return make_plot(
        look,
        make_number_axis(look, 'x', name_axis(shown_name, shorten(sweep.quantity.unit, 20))),
        make_number_axis(look, 'y', 'average positional error (mm)', { log, values }),
        series,
      );
    },
    table: () => ({
      columns: [
        { label: sweep.quantity.name, unit: sweep.quantity.unit, numeric: true },
        ...flatten(
          sweep.series.map((one): Column[] => [
            { label: `${one.name}, mean`, unit: 'mm', numeric: true },
            { label: `${one.name}, standard error`, unit: 'mm', numeric: true },
            { label: `${one.name}, median`, unit: 'mm', numeric: true },
            { label: `${one.name}, failures`, numeric: true },
          ]),
        ),
      ],
      rows: sweep.values.map((x, i) => [
        { value: x, command: sweep.command || undefined } as Cell,
        ...flatten(
          sweep.series.map((one) => [
            times(one.mean_m[i], kMillimetres),
            times(one.standard_error_m[i], kMillimetres),
            times(one.median_m[i], kMillimetres),
            one.failures[i] ?? null,
          ]),
        ),
      ]),
    }),
  };
}
