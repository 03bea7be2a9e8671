// The winner of a problem without an arm: its variables, constraints and metrics, the reasons of failures,
// and the signals and files of its first test case.
import { decimate } from '../charts/decimate';
import { make_curve_plot, make_number_axis } from '../charts/marks';
import { shorten, shorten_all } from '../charts/names';
import { get_series_style, type Look } from '../charts/look';
import { make_line, type Part } from '../charts/parts';
import { parse_csv } from '../csv';
import type { RunData, WinnerFile } from '../data';
import type { Cell, Column, Figure, FilesItem, Item, TableItem, TextItem, Value } from '../model';
import { format_choice, get_shown, is_number, name_axis, times } from './quantities';

const kMostRows = 1000; // of a table of a file

export function make_variable_table(data: RunData): TableItem | null {
  if (data.arm !== null || data.variables.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'variables-table',
    title: 'Variables',
    caption: 'The variables of the problem, where the search began, and the values of the winner.',
    table: {
      columns: [
        { label: 'variable' },
        { label: 'type' },
        { label: 'lower bound', numeric: true },
        { label: 'upper bound', numeric: true },
        { label: 'words' },
        { label: 'start', numeric: true, digits: 6 },
        { label: 'winner', numeric: true, digits: 6 },
        { label: 'unit' },
      ],
      rows: data.variables.map((one): Value[] => {
        const is_word = one.type === 'category';
        const value = (number: number | null): Value => (is_word && is_number(number) ? format_choice(one.choices, number) : number);
        return [
          one.name,
          one.logarithmic ? `${one.type}, logarithmic` : one.type,
          is_word ? null : one.lower,
          is_word ? null : one.upper,
          one.choices.join(', '),
          value(one.start),
          value(one.winner),
          one.unit,
        ];
      }),
    },
  };
}

export function make_limit_table(data: RunData): TableItem | null {
  if (data.limits.length === 0 || data.requirements.length > 0) {
    return null; // the table of requirements has the same limits
  }
  return {
    kind: 'table',
    id: 'limits-table',
    title: 'Constraints',
    caption: 'The constraints of the problem and the values of the winner on the test set.',
    table: {
      columns: [
        { label: 'constraint' },
        { label: 'at most', numeric: true },
        { label: 'winner', numeric: true },
        { label: 'unit' },
        { label: 'state' },
      ],
      rows: data.limits.map((one): (Value | Cell)[] => {
        const shown = get_shown(one.quantity);
        const state: Cell =
          one.is_met === null
            ? { value: '? no number', mark: 'none' }
            : one.is_met
              ? { value: '✓ met', mark: 'good' }
              : { value: '✗ missed', mark: 'bad' };
        return [shown.name, one.limit * shown.factor, times(one.value, shown.factor), shown.unit, state];
      }),
    },
  };
}

export function make_metric_table(data: RunData): TableItem | null {
  if (data.metrics.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'metrics-table',
    title: 'Metrics',
    caption: 'The further numbers of the winner on the test set.',
    table: {
      columns: [{ label: 'metric' }, { label: 'winner', numeric: true }, { label: 'unit' }],
      rows: data.metrics.map((one) => {
        const shown = get_shown(one.quantity);
        return [shown.name, times(one.value, shown.factor), shown.unit];
      }),
    },
  };
}

export function make_reason_table(data: RunData): TableItem | null {
  if (data.failure_reasons.length === 0) {
    return null;
  }
  return {
    kind: 'table',
    id: 'failure-reasons',
    title: 'Failed evaluations',
    caption: 'How many evaluations of the training failed for each reason. The reason is that of the first failed case of an evaluation.',
    table: {
      columns: [{ label: 'evaluations', numeric: true, digits: 8 }, { label: 'reason' }],
      rows: data.failure_reasons.map((one) => [one.count, one.reason]),
    },
  };
}

interface Signal {
  name: string;
  unit: string;
  values: number[];
}

// Returns the columns of a CSV text with a heading, whose abscissa grows; null if it is another text.
// A heading is "speed [rad/s]".
export function read_signals(text: string): Signal[] | null {
  const [heading, ...rows] = parse_csv(text);
  if (heading === undefined || heading.length < 2 || rows.length < 2 || rows.some((row) => row.length !== heading.length)) {
    return null;
  }
  if (rows.some((row) => row.some((cell) => cell.trim() === '' || isNaN(Number(cell))))) {
    return null;
  }
  const signals = heading.map((title, k) => {
    const parts = /^(.*) \[([^\]]*)\]$/.exec(title);
    return { name: parts ? parts[1] : title, unit: parts ? parts[2] : '', values: rows.map((row) => Number(row[k])) };
  });
  const at = signals[0].values;
  return at.every((value, i) => i === 0 || value >= at[i - 1]) ? signals : null;
}

// A limit is drawn only if the signal comes nearer to it than this share.
const kNearLimit = 0.5;

// Returns the edges of the band that a signal must not leave, as dashed lines.
function make_limit_lines(look: Look, index: number, signal: Signal, limit: number | undefined, ends: number[]): Part[] {
  if (limit === undefined || !signal.values.some((value) => Math.abs(value) > kNearLimit * limit)) {
    return [];
  }
  const style = { ...get_series_style(look, index), dash: 'dashed' as const };
  return [limit, -limit].map((value) =>
    make_line(
      look,
      index,
      `${signal.name}: limit`,
      ends.map((at) => [at, value]),
      { width: 1, style },
    ),
  );
}

// Returns one figure per unit. All figures of a record share the pointer and the zoom.
function make_signal_plots(id: string, title: string, signals: Signal[], limits: Record<string, number> = {}): Figure[] {
  const [abscissa, ...curves] = signals;
  const units = curves.map((one) => one.unit).filter((unit, i, all) => all.indexOf(unit) === i);
  return units.map((unit, u) => {
    const shown = curves.filter((one) => one.unit === unit);
    const names = shorten_all(
      shown.map((one) => one.name),
      30,
    );
    const label = unit === '' ? 'value' : shorten(unit, 20);
    return {
      kind: 'figure',
      id: u === 0 ? id : `${id}-${u + 1}`,
      title: names.length > 3 ? `${title} in ${label}` : `${title}: ${names.join(', ')}`,
      caption:
        `The signals of the winner on the first test case over ${shorten(abscissa.name)}, as the problem recorded them.` +
        (Object.keys(limits).length > 0 ? ' Dashed lines are limits, of signals that come near to them.' : ''),
      width: 'full',
      time: { replay: id, case: () => '' },
      draw: (look, _, zoom) => {
        let first = 0;
        let last = abscissa.values.length;
        if (zoom) {
          while (first + 1 < last && abscissa.values[first + 1] < zoom.from) ++first;
          while (last - 2 > first && abscissa.values[last - 2] > zoom.to) --last;
        }
        return make_curve_plot(
          look,
          make_number_axis(look, 'x', name_axis(shorten(abscissa.name), shorten(abscissa.unit, 20)), { min: 'dataMin', max: 'dataMax' }),
          make_number_axis(look, 'y', shown.length === 1 ? name_axis(names[0], shorten(unit, 20)) : label, {}, { nameGap: 54 }),
          shown.flatMap((one, s) => [
            make_line(
              look,
              s,
              names[s],
              decimate(one.values.slice(first, last)).map((i) => [abscissa.values[first + i], one.values[first + i]]),
              { width: 1.4 },
            ),
            ...make_limit_lines(look, s, one, limits[one.name], [abscissa.values[first], abscissa.values[last - 1]]),
          ]),
          { grid: { left: 78, right: 24, top: 44, bottom: 48 } },
        );
      },
      table: () => ({
        columns: [abscissa, ...shown].map((one): Column => ({ label: one.name, unit: one.unit, numeric: true, digits: 6 })),
        rows: abscissa.values.map((at, i): Value[] => [at, ...shown.map((one) => one.values[i])]),
      }),
    };
  });
}

// Returns the plots of a CSV file, or a table if it does not hold signals.
function make_csv_items(file: WinnerFile, index: number): Item[] {
  const text = file.text ?? '';
  const id = `winner-file-${index + 1}`;
  const signals = read_signals(text);
  if (signals !== null) {
    return make_signal_plots(id, file.name, signals);
  }
  const [heading, ...rows] = parse_csv(text);
  if (heading === undefined) {
    return [];
  }
  return [
    {
      kind: 'table',
      id,
      title: file.name,
      caption: rows.length > kMostRows ? `The first ${kMostRows} of ${rows.length} rows.` : undefined,
      table: {
        columns: heading.map((label) => ({ label })),
        rows: rows.slice(0, kMostRows).map((row) => heading.map((_, k): Value => row[k] ?? null)),
      },
    },
  ];
}

// Says why the signals of a record are not shown. A record with files alone has no signals to show.
function make_record_note(record: string): TextItem[] {
  const [heading, ...rows] = parse_csv(record);
  if (heading === undefined || heading.length < 2 || rows.length === 0) {
    return [];
  }
  return [
    {
      kind: 'text',
      id: 'winner-record-note',
      title: 'Signals',
      paragraphs: [
        'The signals in winner-record.csv are not shown. They need at least two rows with a number in every column, ' +
          'and the numbers in the first column must not fall.',
      ],
    },
  ];
}

export function make_record_items(data: RunData): Item[] {
  const signals = data.record === null ? null : read_signals(data.record);
  const files: FilesItem | null =
    data.files.length === 0
      ? null
      : {
          kind: 'files',
          id: 'winner-files',
          title: 'Files of the winner',
          caption: 'The files that the problem left for the winner on the first test case. The names save the files.',
          files: data.files,
        };
  return ([] as Item[]).concat(
    signals === null ? [] : make_signal_plots('winner-record', 'Signals', signals, data.record_limits ?? {}),
    signals === null && data.record !== null ? make_record_note(data.record) : [],
    // The file of a planned motion has the signals of its record.
    ...data.files.map((file, i) => (file.text === null || data.record_limits !== null ? [] : make_csv_items(file, i))),
    files === null ? [] : [files],
  );
}
