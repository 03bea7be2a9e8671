// The history of a run: the objective and the design variables over the generations.
import { get_series_style } from '../charts/look';
import { make_number_axis, make_curve_plot } from '../charts/marks';
import { make_line, type Part, type Point } from '../charts/parts';
import type { RunData } from '../data';
import type { DataTable, Figure, Value } from '../model';
import { format_number } from '../numbers';
import { make_scale_choice } from './distance_response';
import { are_positive, count_of, flatten, get_shown, is_number, name_axis, times } from './quantities';

const kBest = 'best';
const kMean = 'average';
const kIncumbentTest = 'incumbent on the test set';

// Returns "generation", or "evaluations" for an optimizer without generations.
export function name_progress(data: RunData): string {
  return data.training.unit === 'generation' ? 'generation' : 'evaluations';
}

// The best value of a generation or block holds only for its own cases. Other cases show its real
// quality.
export function make_fitness_figure(data: RunData, id = 'fitness'): Figure {
  const { training } = data;
  const { incumbents } = training;
  const shown = get_shown(data.quantity);
  const unit = name_progress(data);
  const values = flatten([training.best, training.mean, incumbents.test]).map((value) => times(value, shown.factor));
  const has_log = !data.logarithmic && are_positive(values);
  const of_it = training.unit === 'generation' ? 'the generation' : 'the block of evaluations';
  return {
    kind: 'figure',
    id,
    title: `Training: ${shown.name}`,
    caption:
      `The best and the average ${shown.name} in ${of_it}, against ${unit === 'generation' ? 'the generation' : 'the number of evaluations'}, ` +
      `on the training cases (schedule ${training.schedule}). Smaller values are better. ` +
      (incumbents.test.some(is_number)
        ? `The symbols are the incumbents on the ${count_of(incumbents.test_cases, 'case')} of ${incumbents.test_set}, ` +
          `${incumbents.engine === '' ? 'computed for this page' : `simulated by ${incumbents.engine}`}. Only these values show the quality of a design. `
        : '') +
      (data.arm ? `The fitness of the thesis is the negative of the error, so it grows when the error falls. ` : '') +
      (training.schedule.indexOf('fixed') !== 0
        ? 'Each generation has new cases, so the curves jump with the difficulty of the cases. '
        : '') +
      `Where the average is far above the best, many designs fail.`,
    width: 'full',
    height: 380,
    choices: [
      {
        id: 'abscissa',
        label: 'against',
        options: [
          { value: 'index', label: unit },
          { value: 'cases', label: 'simulated cases' },
        ],
        initial: 'index',
      },
      ...(has_log ? [make_scale_choice('log')] : []),
    ],
    draw: (look, picked) => {
      const by_cases = picked.abscissa === 'cases';
      const x = by_cases ? training.cases : training.index;
      const x_incumbents = by_cases ? incumbents.cases : incumbents.index;
      const log = has_log && picked.scale !== 'linear';
      const line = (values: (number | null)[]): Point[] => values.map((value, i) => [x[i], times(value, shown.factor)]);
      const tests: Point[] = incumbents.test.map((value, i) => ({
        value: [x_incumbents[i], times(value, shown.factor)],
        note:
          `Best known after ${count_of(incumbents.cases[i], 'case')}: ${format_number(times(incumbents.training[i], shown.factor))} ` +
          `in training, ${format_number(times(value, shown.factor))} on ${incumbents.test_set} ${shown.unit}`.trim(),
      }));
      const style = get_series_style(look, 1);
      const series: Part[] = [
        make_line(look, 5, kMean, line(training.mean), {
          width: 1.4,
          style: { ...get_series_style(look, 6), dash: 'dotted' },
        }),
        make_line(look, 0, kBest, line(training.best), { width: 1.4 }),
      ];
      if (incumbents.test.some(is_number)) {
        series.push({
          ...make_line(look, 1, kIncumbentTest, tests, { symbols: true, width: 1.4, step: 'end', style }),
          showAllSymbol: tests.length < 60,
          symbolSize: tests.length < 60 ? 7 : 4,
        });
      }
      return make_curve_plot(
        look,
        make_number_axis(look, 'x', by_cases ? 'simulated training cases' : unit, { max: 'dataMax' }),
        make_number_axis(look, 'y', name_axis(shown.name, shown.unit), { log, values }),
        series,
      );
    },
    table: () => tabulate_training(data),
  };
}

function tabulate_training(data: RunData): DataTable {
  const { training } = data;
  const { incumbents } = training;
  const shown = get_shown(data.quantity);
  const rows: Value[][] = training.index.map((index, i) => [
    index,
    training.cases[i],
    times(training.best[i], shown.factor),
    times(training.mean[i], shown.factor),
    times(training.worst[i], shown.factor),
    training.failed[i],
    null,
    null,
  ]);
  const row_of: Record<string, Value[]> = {};
  rows.forEach((row) => {
    row_of[String(row[0])] = row;
  });
  incumbents.index.forEach((index, i) => {
    let row = row_of[String(index)];
    if (row === undefined) {
      row = [index, incumbents.cases[i], null, null, null, null, null, null];
      rows.push(row);
    }
    row[6] = times(incumbents.training[i], shown.factor);
    row[7] = times(incumbents.test[i], shown.factor);
  });
  rows.sort((a, b) => (a[0] as number) - (b[0] as number));
  const column = (label: string) => ({ label, unit: shown.unit, numeric: true });
  return {
    columns: [
      { label: name_progress(data), numeric: true, digits: 8 },
      { label: 'cases', numeric: true, digits: 8 },
      column('best'),
      column('average'),
      column('worst'),
      { label: 'evaluations without number', numeric: true },
      column('incumbent, training'),
      column('incumbent, test set'),
    ],
    rows,
  };
}

export function has_training(data: RunData): boolean {
  return data.training.index.length > 0 && (data.training.best.some(is_number) || data.training.mean.some(is_number));
}
