// The result of a run with several objectives: the front of its evaluations.
import { get_series_style } from '../charts/look';
import { make_number_axis, make_plot } from '../charts/marks';
import { shorten } from '../charts/names';
import type { Part } from '../charts/parts';
import type { RunFront, VariableHistory } from '../data';
import type { Choice, Figure, Picked, Value } from '../model';
import { format_number } from '../numbers';
import { are_positive, find_range, format_choice, get_shown, name_axis } from './quantities';

const kWide = 10; // ratio of the largest to the smallest value from which an axis is logarithmic

export function make_front_figure(front: RunFront, variables: VariableHistory[]): Figure | null {
  const count = front.objectives.length;
  if (count < 2 || front.points.length === 0) {
    return null;
  }
  const shown = front.objectives.map(get_shown);
  const options = front.objectives.map((one, i) => ({ value: String(i), label: shorten(one.name) }));
  const choices: Choice[] = [
    { id: 'x', label: 'across', options, initial: '0' },
    { id: 'y', label: 'up', options, initial: '1' },
  ];
  const get_axes = (picked: Picked): [number, number] => [Number(picked.x ?? 0), Number(picked.y ?? 1)];
  const value_of = (point: number, objective: number) => front.points[point].values[objective] * shown[objective].factor;
  const on_front = front.points.map((_, i) => i).filter((i) => front.points[i].on_front);
  const name_point = (i: number) =>
    `Evaluation ${front.points[i].evaluation}: ${shown.map((one, k) => `${one.name} ${format_number(value_of(i, k))} ${one.unit}`.trim()).join(', ')}. ` +
    front.points[i].x
      .map(
        (value, k) => `${variables[k] ? shorten(variables[k].name) : `x${k + 1}`} = ${format_choice(variables[k]?.choices ?? [], value)}`,
      )
      .join(', ');
  return {
    kind: 'figure',
    id: 'front',
    title: 'Front of the objectives',
    caption:
      `The designs that the run evaluated, by ${shown.map((one) => one.name).join(' and ')}. Designs towards the lower left are better. ` +
      `The ${on_front.length} bold designs are the front: none of them is better than another in all objectives. ` +
      (count === 2 ? 'The line under them bounds the area that they attain. ' : '') +
      (front.winner !== null ? 'The diamond is the winner by the weighted sum. ' : '') +
      (front.points.some((point) => point.file !== null) ? 'Choose a design, here or in the table, to save it. ' : '') +
      'An axis is logarithmic if its numbers spread over more than a decade.',
    width: 'full',
    height: 420,
    choices: count > 2 ? choices : undefined,
    draw: (look, picked) => {
      const axes = get_axes(picked);
      const at = (i: number) => ({
        value: axes.map((axis) => value_of(i, axis)),
        note: name_point(i),
        command: front.points[i].file?.command,
        file: front.points[i].file ?? undefined,
      });
      const logs = axes.map((axis) => {
        const values = front.points.map((_, i) => value_of(i, axis));
        const range = find_range(values);
        return are_positive(values) && range !== null && range[1] > kWide * range[0];
      });
      const style = get_series_style(look, 0);
      const series: Part[] = [];
      const off = front.points.map((_, i) => i).filter((i) => !front.points[i].on_front);
      if (off.length > 0) {
        series.push({
          type: 'scatter',
          name: 'evaluated',
          data: off.map(at),
          symbolSize: 4,
          itemStyle: { color: look.muted, opacity: 0.45 },
        });
      }
      if (count === 2) {
        const sorted = on_front.slice().sort((a, b) => value_of(a, axes[0]) - value_of(b, axes[0]));
        series.push({
          type: 'line',
          name: 'front',
          data: sorted.map((i) => at(i).value),
          step: 'end',
          showSymbol: false,
          silent: true,
          lineStyle: { color: style.color, width: 1.2 },
          itemStyle: { color: style.color },
        });
      }
      series.push({
        type: 'scatter',
        name: 'front',
        data: on_front.map(at),
        symbol: 'circle',
        symbolSize: 7,
        itemStyle: { color: style.color },
      });
      if (front.winner !== null && front.points[front.winner] !== undefined) {
        series.push({
          type: 'scatter',
          name: 'winner',
          data: [at(front.winner)],
          symbol: 'diamond',
          symbolSize: 14,
          itemStyle: { color: get_series_style(look, 1).color, borderColor: look.background, borderWidth: 1 },
          z: 5,
        });
      }
      const axis = (which: 0 | 1) =>
        make_number_axis(look, which === 0 ? 'x' : 'y', name_axis(shown[axes[which]].name, shown[axes[which]].unit), {
          log: logs[which],
          values: front.points.map((_, i) => value_of(i, axes[which])),
        });
      return make_plot(look, axis(0), { ...axis(1), nameGap: 58 }, series, { grid: { left: 80, right: 24, top: 44, bottom: 48 } });
    },
    table: () => {
      const dimension = front.points[0].x.length;
      const is_word = (k: number) => variables[k] !== undefined && variables[k].choices.length > 0;
      const names = front.points[0].x.map((_, k) => (variables[k] ? variables[k].name : `x${k + 1}`));
      return {
        columns: [
          { label: 'evaluation', numeric: true, digits: 9 },
          { label: 'on the front' },
          ...shown.map((one) => ({ label: one.name, unit: one.unit, numeric: true })),
          ...names.map((label, k) => ({ label, unit: variables[k] ? variables[k].unit : '', numeric: true })),
        ],
        rows: front.points.map((point, i) => [
          { value: point.evaluation, note: name_point(i), command: point.file?.command, file: point.file ?? undefined },
          (i === front.winner ? 'winner' : point.on_front ? 'yes' : 'no') as Value,
          ...shown.map((_, k) => value_of(i, k)),
          ...names
            .slice(0, dimension)
            .map((_, k): Value => (is_word(k) ? format_choice(variables[k].choices, point.x[k]) : (point.x[k] ?? null))),
        ]),
      };
    },
  };
}
