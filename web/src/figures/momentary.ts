// The momentary positional error over time (Fig. 6.5-6.8 of the thesis): either move by move, where
// each move has its own time axis, or a whole case.
import { decimate } from '../charts/decimate';
import type { Look } from '../charts/look';
import { get_line_style, make_number_axis, make_panel_title, make_panels, make_curve_plot, make_stretches } from '../charts/marks';
import { make_line, type Part, type Point } from '../charts/parts';
import type { Range } from '../charts/zoom';
import type { ReplayCase, ReplaySet } from '../data';
import type { Choice, DataTable, Figure, Picked, Value } from '../model';
import { format_number, kMillimetres, unpack } from '../numbers';
import { make_scale_choice } from './distance_response';
import { choose_rows, get_case, get_motions, get_time, get_window, kAll, make_case_choice, make_design_choice } from './replay_access';

// A line of the figure: the error of one design on one case.
export interface ErrorTrace {
  name: string;
  style: number;
  set: ReplaySet;
  one: ReplayCase;
  error_m: Float32Array;
}

const kPanels = 6; // distance classes side by side, as in the thesis
const kPointsAPanel = 600;
const kFloor_mm = 1e-4; // lower end of a logarithmic axis; smaller errors are not shown

function to_point(time: number, error_m: number, log: boolean): Point {
  const error = error_m * kMillimetres;
  return [time, isFinite(error) ? (log ? Math.max(error, kFloor_mm) : error) : null];
}

// Returns the part of a trace within a move. Its time starts with the move. `index` counts moves
// from 0.
function get_move(trace: ErrorTrace, index: number): Float32Array {
  const segment = trace.one.segments[index];
  return segment === undefined ? new Float32Array(0) : trace.error_m.subarray(segment.first_step, segment.first_step + segment.steps);
}

function name_class(one: ReplayCase, index: number): string {
  return `class ${index + 1}: ${one.segments[index].distance_m.toFixed(3)} m`;
}

// Draws panels of moves, one panel per distance class. The classes are those of the case of the
// first trace.
export function draw_moves(look: Look, traces: ErrorTrace[], classes: number[], log: boolean, height: number) {
  const shown = classes.filter((index) => traces.length > 0 && traces[0].one.segments[index] !== undefined);
  const columns = shown.length > 4 ? 3 : shown.length > 1 ? 2 : 1;
  const grids = make_panels(Math.max(1, shown.length), columns, height);
  const many = shown.length > 1;
  const series: Part[] = [];
  shown.forEach((index, panel) => {
    const first = traces[0];
    series.push(make_stretches(look, [get_window(first.set, first.one.segments[index])], look.accent, panel, 0.09));
    traces.forEach((trace) => {
      const values = get_move(trace, index);
      const points = decimate(values, kPointsAPanel).map((i) => to_point(get_time(trace.set, i), values[i], log));
      series.push(
        make_line(look, trace.style, trace.name, points, {
          axis: panel,
          width: 1.4,
          style: get_line_style(look, trace.style),
          on_top: trace.style === 0,
        }),
      );
    });
  });
  return make_curve_plot(
    look,
    grids.map((_, i) =>
      make_number_axis(look, 'x', i + columns >= grids.length ? 'time in the move (s)' : '', {
        index: i,
        min: 0,
        max: 'dataMax',
      }),
    ),
    grids.map((_, i) => make_number_axis(look, 'y', i % columns === 0 ? 'error (mm)' : '', { index: i, log }, { nameGap: 44 })),
    series,
    { grid: grids, title: many ? shown.map((index, i) => make_panel_title(look, grids[i], name_class(traces[0].one, index))) : undefined },
  );
}

function draw_case(look: Look, traces: ErrorTrace[], log: boolean, zoom: Range | undefined) {
  const series: Part[] = [];
  const first = traces[0];
  if (first !== undefined) {
    const dt = first.set.task.control_period_s;
    const windows = first.one.segments.map((segment): [number, number] => {
      const window = get_window(first.set, segment);
      return [segment.first_step * dt + window[0], segment.first_step * dt + window[1]];
    });
    series.push(make_stretches(look, windows, look.accent, 0, 0.09));
  }
  traces.forEach((trace) => {
    const points = choose_rows(trace.set, trace.error_m, zoom).map((i) => to_point(get_time(trace.set, i), trace.error_m[i], log));
    series.push(
      make_line(look, trace.style, trace.name, points, { width: 1.2, style: get_line_style(look, trace.style), on_top: trace.style === 0 }),
    );
  });
  return make_curve_plot(
    look,
    make_number_axis(look, 'x', 'time (s)', { min: 0, max: 'dataMax' }),
    make_number_axis(look, 'y', 'positional error (mm)', { log }),
    series,
  );
}

export function tabulate_moves(traces: ErrorTrace[], classes: number[]): DataTable {
  const rows: Value[][] = [];
  traces.forEach((trace) => {
    classes.forEach((index) => {
      const values = get_move(trace, index);
      for (let i = 0; i < values.length; ++i) {
        const error = values[i] * kMillimetres;
        rows.push([trace.name, index + 1, get_time(trace.set, i), isFinite(error) ? error : null]);
      }
    });
  });
  return {
    columns: [
      { label: 'design' },
      { label: 'distance class', numeric: true },
      { label: 'time from the start of the move', unit: 's', numeric: true },
      { label: 'error', unit: 'mm', numeric: true },
    ],
    rows,
  };
}

function tabulate_case(traces: ErrorTrace[]): DataTable {
  const rows: Value[][] = [];
  let steps = 0;
  traces.forEach((trace) => {
    steps = Math.max(steps, trace.error_m.length);
  });
  for (let i = 0; i < steps; ++i) {
    rows.push([
      get_time(traces[0].set, i),
      ...traces.map((trace): Value => (i < trace.error_m.length && isFinite(trace.error_m[i]) ? trace.error_m[i] * kMillimetres : null)),
    ]);
  }
  return {
    columns: [
      { label: 'time', unit: 's', numeric: true, digits: 6 },
      ...traces.map((trace) => ({ label: trace.name, unit: 'mm', numeric: true })),
    ],
    rows,
  };
}

function get_traces(set: ReplaySet, picked: Picked): ErrorTrace[] {
  const one = get_case(set, picked);
  return get_motions(set, one, picked).map((moved) => ({
    name: moved.name,
    style: moved.index,
    set,
    one,
    error_m: unpack(moved.motion.error_m),
  }));
}

// Returns the move indices of a text: "2-7" gives 1 to 6.
function get_classes(value: string): number[] {
  const ends = value.split('-').map(Number);
  const classes: number[] = [];
  for (let i = ends[0]; i <= (ends[1] ?? ends[0]); ++i) {
    classes.push(i - 1);
  }
  return classes;
}

// Returns the time in the case of each move that the case has.
function list_times(set: ReplaySet, one: ReplayCase, classes: number[]): Range[] {
  const dt = set.task.control_period_s;
  return classes
    .map((index) => one.segments[index])
    .filter((segment) => segment !== undefined)
    .map((segment) => ({ from: segment.first_step * dt, to: (segment.first_step + segment.steps) * dt }));
}

// Returns the choice of classes: the groups of six of the thesis from class 2 on, then every single
// class.
function make_class_choice(set: ReplaySet): Choice {
  let moves = 0;
  set.cases.forEach((one) => {
    moves = Math.max(moves, one.segments.length);
  });
  const options: Choice['options'] = [];
  for (let begin = 2; begin <= moves; begin += kPanels) {
    const end = Math.min(moves, begin + kPanels - 1);
    if (end > begin) {
      options.push({ value: `${begin}-${end}`, label: `classes ${begin} to ${end}` });
    }
  }
  options.push({ value: kAll, label: 'whole case' });
  for (let i = 1; i <= moves; ++i) {
    options.push({ value: String(i), label: `class ${i}` });
  }
  return { id: 'classes', label: 'moves', options, initial: options[0].value };
}

export function make_momentary_figure(set: ReplaySet, id = 'momentary-error'): Figure | null {
  if (set.cases.length === 0 || set.designs.length === 0) {
    return null;
  }
  const class_choice = make_class_choice(set);
  const height = 480;
  const get_picked_classes = (picked: Picked) => picked.classes ?? class_choice.initial;
  return {
    kind: 'figure',
    id,
    title: 'Momentary positional error',
    caption:
      `The distance of the tip from its target at every control period of ${format_number(set.task.control_period_s * kMillimetres, 3)} ms. ` +
      `The figure shows the moves of the chosen distance classes, with the time from the start of each move, or the whole case. Class n is the move to trajectory point n. ` +
      `In shaded times the error is measured, and its mean counts. ` +
      `Fig. 6.5 to 6.8 of the thesis show the same for its test case of generation 1.`,
    width: 'full',
    height,
    choices: [make_case_choice(set), class_choice, make_design_choice(set, true), make_scale_choice('log')],
    time: {
      replay: set.id,
      case: (picked) => get_case(set, picked).id,
      panels: (picked) => {
        const classes = get_picked_classes(picked);
        return classes === kAll ? [] : list_times(set, get_case(set, picked), get_classes(classes));
      },
    },
    draw: (look, picked, zoom) => {
      const log = picked.scale !== 'linear';
      const classes = get_picked_classes(picked);
      const traces = get_traces(set, picked);
      return classes === kAll ? draw_case(look, traces, log, zoom) : draw_moves(look, traces, get_classes(classes), log, height);
    },
    table: (picked) => {
      const classes = get_picked_classes(picked);
      const traces = get_traces(set, picked);
      return classes === kAll ? tabulate_case(traces) : tabulate_moves(traces, get_classes(classes));
    },
  };
}

// Makes Fig. 6.5-6.8: some classes of traces from different sets.
export function make_class_figure(traces: ErrorTrace[], first: number, last: number, id: string, thesis: string): Figure {
  const classes = get_classes(`${first}-${last}`);
  const height = 460;
  const one = traces[0].one;
  const distances = classes.filter((index) => one.segments[index] !== undefined).map((index) => one.segments[index].distance_m.toFixed(3));
  return {
    kind: 'figure',
    id,
    title: `Momentary positional error, distance classes ${first} to ${last}`,
    thesis,
    caption:
      `The distance of the tip from its target in the moves of distance classes ${first} to ${last} (${distances.join(', ')} m), ` +
      `over the time from the start of each move. The figure has ${traces.length} designs, each with its own reference signal, on the same case: that of generation 1. ` +
      `In shaded times the error is measured. ` +
      `With the signal Step the target is at the end of the move at once, so the error starts with the whole distance.`,
    width: 'full',
    height,
    choices: [make_scale_choice('log')],
    draw: (look, picked) => draw_moves(look, traces, classes, picked.scale !== 'linear', height),
    table: () => tabulate_moves(traces, classes),
  };
}
