// All published errors compared with the errors of new simulations, in one figure.
import { make_labels } from '../charts/labels';
import { get_series_style } from '../charts/look';
import { make_number_axis, make_plot } from '../charts/marks';
import { shorten } from '../charts/names';
import { make_line, type Part } from '../charts/parts';
import type { ReproductionData } from '../data';
import type { Cell, Figure, Value } from '../model';
import { format_number, kMillimetres } from '../numbers';
import { are_positive, find_range, is_number } from './quantities';

export function make_published_figure(data: ReproductionData): Figure | null {
  const rows = data.rows.filter((row) => is_number(row.published_error_m) && is_number(row.mean_m));
  const range = find_range(rows.map((row) => row.published_error_m).concat(rows.map((row) => row.mean_m)));
  if (range === null) {
    return null;
  }
  const mm = (value: number | null) => (value as number) * kMillimetres;
  const log = are_positive(rows.map((row) => row.published_error_m).concat(rows.map((row) => row.mean_m)));
  const ends = log ? [(range[0] * kMillimetres) / 2, range[1] * kMillimetres * 2] : [range[0] * kMillimetres, range[1] * kMillimetres];
  return {
    kind: 'figure',
    id: 'published',
    title: 'Published errors and ours',
    caption:
      'The average positional error of each published design, as simulated here, against the error that the thesis printed. Points on the line agree. ' +
      'The design of a point above the line is worse here than in the thesis.',
    width: 'full',
    height: 420,
    draw: (look) => {
      const style = get_series_style(look, 0);
      const points = rows.map((row) => ({
        value: [mm(row.published_error_m), mm(row.mean_m)] as [number, number],
        name: shorten(row.label, 24),
        command: row.command || undefined,
        note: `${shorten(row.label)}: published ${format_number(mm(row.published_error_m))} mm (${shorten(row.where)}), here ${format_number(mm(row.mean_m))} mm over ${row.cases} cases.`,
      }));
      const series: Part[] = [
        make_line(
          look,
          0,
          'agreement',
          [
            [ends[0], ends[0]],
            [ends[1], ends[1]],
          ],
          {
            width: 1.2,
            style: { color: look.muted, dash: 'dashed', symbol: 'none' },
          },
        ),
        {
          type: 'scatter',
          name: 'published designs',
          data: points,
          symbol: 'circle',
          symbolSize: 9,
          itemStyle: { color: style.color },
        },
        make_labels(
          look,
          points.map((point) => point.value),
          points.map((point) => point.name),
        ),
      ];
      return make_plot(
        look,
        make_number_axis(look, 'x', 'published average error (mm)', { log, min: log ? undefined : 0, values: ends }),
        make_number_axis(look, 'y', 'average error here (mm)', { log, min: log ? undefined : 0, values: ends }),
        series,
      );
    },
    table: () => ({
      columns: [{ label: 'result' }, { label: 'published', unit: 'mm', numeric: true }, { label: 'here', unit: 'mm', numeric: true }],
      rows: rows.map((row): (Value | Cell)[] => [
        { value: row.label, command: row.command || undefined },
        mm(row.published_error_m),
        mm(row.mean_m),
      ]),
    }),
  };
}
