// The page of an identification: what was found of a robot, how well it explains the recorded efforts,
// and the arm as it was recorded.
import { decimate } from '../charts/decimate';
import type { Look } from '../charts/look';
import { make_curve_plot, make_number_axis, make_panel_title } from '../charts/marks';
import { shorten, shorten_all } from '../charts/names';
import { make_chart, make_line, make_spans, type Part } from '../charts/parts';
import type { Range } from '../charts/zoom';
import type { FitSet, FittedParameter, Identification, RecordedMotion, RunData } from '../data';
import type { Cell, Choice, Figure, GradeLine, Picked, SummaryItem, TableItem, Tile, Value } from '../model';
import { format_duration, format_number, unpack } from '../numbers';
import { count_of, flatten, is_number, name_axis } from './quantities';
import { take_column } from './replay_access';

const kReplay = 'recorded'; // the id of the replay (src/report/page/identification_part.cpp)
const kWhite = 0.05;

// ---------------------------------------------------------------- headline

function divide(a: number | null, b: number | null): number | null {
  return is_number(a) && is_number(b) && b !== 0 ? a / b : null;
}

function list_logs(set: FitSet): string {
  return set.logs.map((log) => shorten(log)).join(', ');
}

function make_error_tile(label: string, set: FitSet): Tile {
  const ratio = divide(set.error_after, set.error_before);
  return {
    label,
    value: `${format_number(set.error_before, 3)} → ${format_number(set.error_after, 3)}`,
    detail:
      `deviations of the torque, mean of the joints; ${format_number(ratio, 3)} times that of the robot as described; ` + list_logs(set),
    mark: is_number(ratio) ? (ratio < 1 ? 'good' : 'bad') : undefined,
  };
}

// A sentence may begin with the name of a parameter, which keeps its letters.
function end_sentence(text: string): string {
  return (/^[a-z]+ /.test(text) ? text.charAt(0).toUpperCase() + text.slice(1) : text) + '.';
}

export function make_doubts_item(found: Identification): SummaryItem {
  const count = found.doubts.length;
  return {
    kind: 'summary',
    id: 'doubts',
    title: 'Doubts',
    verdict:
      count > 0
        ? { text: `! Read ${count === 1 ? 'this' : `these ${count}`} before you use the plant.`, mark: 'near' }
        : {
            text: '✓ The search came to its end, no parameter is at the end of its range, and the fit is better than before.',
            mark: 'good',
          },
    tiles: [],
    lines: found.doubts.map((doubt): GradeLine => ({
      name: 'Doubt',
      state: '! look',
      mark: 'near',
      value: end_sentence(doubt),
      meaning: '',
    })),
  };
}

export function make_identification_headline(data: RunData, found: Identification): SummaryItem {
  const { parameters } = found;
  const untold = parameters.filter((one) => !one.determined).length;
  const at_bound = parameters.filter((one) => one.at_bound).length;
  const zero = parameters.filter(may_be_zero).length;
  const { times } = data.headline;
  const tiles: Tile[] = [
    ...(found.held_back === null ? [] : [make_error_tile('Error on logs held back', found.held_back)]),
    make_error_tile('Error on fitted logs', found.fitted),
    {
      label: 'Parameters',
      value: String(parameters.length),
      detail: [
        untold > 0 ? `${untold} cannot be told from the motions` : 'all can be told from the motions',
        zero > 0 ? `${zero} may be 0` : '',
        at_bound > 0 ? `${at_bound} at the end of the range` : '',
      ]
        .filter((text) => text !== '')
        .join('; '),
    },
  ];
  if (times !== null) {
    tiles.push({
      label: 'Time taken',
      value: format_duration(times.wall_s),
      detail: `${count_of(data.headline.evaluations, 'evaluation')}`,
    });
  }
  return { kind: 'summary', id: 'identification', title: '', tiles, lines: [] };
}

// ---------------------------------------------------------------- tables

export function make_fit_table(found: Identification): TableItem {
  const rows: (Value | Cell)[][] = [];
  const add = (set: FitSet, which: string): void =>
    set.joints.forEach((joint) => {
      const ratio = divide(joint.rms_after, joint.rms_before);
      const is_white = is_number(joint.whiteness_p) && joint.whiteness_p >= kWhite;
      rows.push([
        joint.joint,
        which,
        joint.unit,
        joint.deviation,
        joint.rms_before,
        joint.rms_after,
        { value: ratio, mark: is_number(ratio) && ratio > 1 ? 'bad' : undefined },
        is_white
          ? { value: '✓ white', mark: 'good' }
          : is_number(joint.independent_s)
            ? { value: `! repeat over ${format_number(joint.independent_s, 2)} s`, mark: 'near' }
            : { value: '? no number', mark: 'none' },
      ]);
    });
  add(found.fitted, 'fitted');
  if (found.held_back !== null) {
    add(found.held_back, 'held back');
  }
  return {
    kind: 'table',
    id: 'fit-table',
    title: 'Joints',
    caption:
      'The root mean square of the recorded torque minus that of the model, with the parameters that the robot had before and with the fitted ones. ' +
      'White residuals leave nothing to explain. Others repeat: the model misses something that lasts for the time that is stated, and the intervals of the parameters take it into account.',
    table: {
      columns: [
        { label: 'joint' },
        { label: 'logs' },
        { label: 'unit' },
        { label: 'deviation of the torque', numeric: true },
        { label: 'error before', numeric: true },
        { label: 'error after', numeric: true },
        { label: 'after / before', numeric: true, digits: 3 },
        { label: 'residuals' },
      ],
      rows,
    },
  };
}

// Whether the interval has 0 in it.
function may_be_zero(one: FittedParameter): boolean {
  return one.determined && is_number(one.lower) && is_number(one.upper) && one.lower <= 0 && one.upper >= 0;
}

function describe_state(one: FittedParameter): Cell {
  if (!one.determined) {
    return { value: '? cannot be told', mark: 'none' };
  }
  if (one.at_bound) {
    return { value: '! at the end of its range', mark: 'near' };
  }
  return may_be_zero(one) ? { value: '? may be 0', mark: 'none' } : { value: '✓ told', mark: 'good' };
}

export function make_parameter_table(found: Identification): TableItem {
  return {
    kind: 'table',
    id: 'parameters-table',
    title: 'Parameters',
    caption: [
      "Before: the robot's own values. The interval holds the true value in 95 of 100 such recordings, if the model is right.",
      ...found.undetermined.map(end_sentence),
    ].join(' '),
    table: {
      columns: [
        { label: 'parameter' },
        { label: 'before', numeric: true },
        { label: 'value', numeric: true, digits: 5 },
        { label: '95 % from', numeric: true },
        { label: 'to', numeric: true },
        { label: 'unit' },
        { label: 'state' },
      ],
      rows: found.parameters.map((one): (Value | Cell)[] => [
        one.name,
        one.before,
        one.value,
        one.lower,
        one.upper,
        one.unit,
        describe_state(one),
      ]),
    },
  };
}

export function make_correlation_table(found: Identification): TableItem | null {
  if (found.correlations.length === 0) {
    return null;
  }
  const size = (value: number | null): number => (value === null ? 0 : Math.abs(value));
  const sorted = found.correlations.slice().sort((a, b) => size(b.value) - size(a.value));
  return {
    kind: 'table',
    id: 'correlations-table',
    title: 'Parameters that depend on each other',
    caption:
      'Pairs of parameters whose estimates are correlated by more than 0.9: the motions tell their combination better than each of the two. ' +
      'Near 1, both are too large or too small together; near -1, one is too large where the other is too small.',
    table: {
      columns: [{ label: 'parameter' }, { label: 'and' }, { label: 'correlation', numeric: true }],
      rows: sorted.map((pair): Value[] => [pair.first, pair.second, pair.value]),
    },
  };
}

// ---------------------------------------------------------------- intervals

const kRow_px = 22;
const kLow = -100; // %; the ends of the abscissa
const kHigh = 300;
const kValue = 'value and its 95 % interval';

interface Relative {
  name: string;
  lower: number;
  upper: number;
  before: number | null;
}

// Returns intervals as shares of the value, in percent. A value of 0 has none.
function list_relative(found: Identification): Relative[] {
  const names = shorten_all(found.parameters.map((one) => one.name));
  const list: Relative[] = [];
  found.parameters.forEach((one, i) => {
    const [lower, upper, before] = [one.lower, one.upper, one.before].map((value) => divide(value, one.value));
    if (lower !== null && upper !== null) {
      list.push({
        name: names[i],
        lower: 100 * Math.min(lower, upper),
        upper: 100 * Math.max(lower, upper),
        before: before === null ? null : 100 * before,
      });
    }
  });
  return list;
}

export function make_interval_figure(found: Identification): Figure | null {
  const list = list_relative(found);
  if (list.length === 0) {
    return null;
  }
  const clip = (value: number): number => Math.max(kLow, Math.min(kHigh, value));
  return {
    kind: 'figure',
    id: 'intervals',
    title: 'Intervals of the parameters',
    caption:
      'The 95 % interval of each parameter as a share of its value, and what the robot had before. ' +
      `An interval that reaches 0 % leaves open whether the parameter is there at all. Intervals are cut at ${kLow} % and ${kHigh} %.`,
    width: 'full',
    height: 110 + kRow_px * list.length,
    draw: (look) => {
      const mark = (name: string, style: Part, values: (number | null)[]): Part => ({
        type: 'scatter',
        name,
        data: values.map((value, i) => ({ value: [value, list[i].name], note: describe_interval(list[i]) })),
        symbol: 'circle',
        symbolSize: 9,
        itemStyle: style,
        z: 4,
      });
      return make_chart(
        look,
        make_number_axis(look, 'x', 'share of the value (%)', { min: kLow, max: kHigh }),
        {
          ...make_number_axis(look, 'y', '', { categories: list.map((one) => one.name), inverse: true }),
          axisLabel: { color: look.text, fontFamily: look.font, fontSize: 11, interval: 0, width: 190, overflow: 'truncate' },
        },
        [
          make_spans(
            kValue,
            list.map((one, i): [number, number, number] => [i, clip(one.lower), clip(one.upper)]),
            look.series[0],
          ),
          mark(
            kValue,
            { color: look.series[0] },
            list.map(() => 100),
          ),
          mark(
            'before',
            { color: look.background, borderColor: look.series[1], borderWidth: 2 },
            list.map((one) => (one.before === null || clip(one.before) !== one.before ? null : one.before)),
          ),
        ],
        { grid: { left: 206, right: 24, top: 44, bottom: 48 } },
      );
    },
    table: () => ({
      columns: [
        { label: 'parameter' },
        { label: '95 % from', unit: '% of the value', numeric: true },
        { label: 'to', unit: '% of the value', numeric: true },
        { label: 'before', unit: '% of the value', numeric: true },
      ],
      rows: list.map((one): Value[] => [one.name, one.lower, one.upper, one.before]),
    }),
  };
}

function describe_interval(one: Relative): string {
  const before = one.before === null ? '' : `; before: ${format_number(one.before, 3)} %`;
  return `${one.name}: ${format_number(one.lower, 3)} to ${format_number(one.upper, 3)} % of the value${before}`;
}

// ---------------------------------------------------------------- torques over time

interface Curves {
  motion: RecordedMotion;
  unit: string;
  joint: string;
  recorded: Float32Array;
  before: Float32Array;
  after: Float32Array;
}

function get_curves(found: Identification, picked: Picked): Curves {
  const joints = found.fitted.joints;
  const motion = found.motions.filter((one) => one.id === picked.log)[0] ?? found.motions[0];
  const index = Math.min(joints.length - 1, Number(picked.joint ?? 0));
  const get = (packed: RecordedMotion['recorded']) => take_column(unpack(packed), joints.length, index);
  const { joint, unit } = joints[index];
  return {
    motion,
    joint: shorten(joint),
    unit: shorten(unit, 20),
    recorded: get(motion.recorded),
    before: get(motion.before),
    after: get(motion.after),
  };
}

function subtract(a: Float32Array, b: Float32Array): Float32Array {
  const rest = new Float32Array(a.length);
  for (let i = 0; i < a.length; ++i) {
    rest[i] = a[i] - b[i];
  }
  return rest;
}

// Returns the part of the values within the zoom and one beyond each end, thinned for drawing.
function choose_points(values: Float32Array, period_s: number, zoom: Range | undefined): [Value, Value][] {
  const first = zoom === undefined ? 0 : Math.max(0, Math.floor(zoom.from / period_s) - 1);
  const last = zoom === undefined ? values.length : Math.min(values.length, Math.ceil(zoom.to / period_s) + 2);
  return decimate(values.subarray(first, Math.max(first, last))).map((i) => [
    (first + i) * period_s,
    isFinite(values[first + i]) ? values[first + i] : null,
  ]);
}

function draw_efforts(look: Look, curves: Curves, zoom: Range | undefined) {
  const { motion, unit, joint, recorded, before, after } = curves;
  const grids = [
    { left: 78, right: 24, top: '11%', height: '46%' },
    { left: 78, right: 24, top: '65%', height: '25%' },
  ];
  const line = (name: string, index: number, values: Float32Array, axis: number, dash?: 'dashed'): Part =>
    make_line(look, index, name, choose_points(values, motion.period_s, zoom), {
      axis,
      width: index === 6 ? 2 : 1.3,
      style: { color: index === 6 ? look.text : look.series[index], dash: dash ?? 'solid', symbol: 'none' },
    });
  const quantity = unit === 'N' ? 'force' : 'torque';
  return make_curve_plot(
    look,
    grids.map((_, i) => make_number_axis(look, 'x', i === 1 ? 'time (s)' : '', { index: i, min: 0, max: 'dataMax' })),
    [quantity, 'residual'].map((name, i) =>
      make_number_axis(look, 'y', name_axis(name, unit), { index: i }, { nameGap: 54, splitNumber: i === 0 ? 5 : 3 }),
    ),
    [
      line('recorded', 6, recorded, 0),
      line('model before', 1, before, 0, 'dashed'),
      line('model after', 0, after, 0),
      line('residual before', 1, subtract(recorded, before), 1, 'dashed'),
      line('residual after', 0, subtract(recorded, after), 1),
    ],
    {
      grid: grids,
      title: [`${joint}, ${shorten(motion.log)}`, 'recorded minus model'].map((text, i) => make_panel_title(look, grids[i], text)),
    },
  );
}

export function make_effort_figure(found: Identification): Figure | null {
  const { motions } = found;
  const joints = found.fitted.joints;
  if (motions.length === 0 || joints.length === 0) {
    return null;
  }
  const logs = shorten_all(motions.map((one) => `${one.log}, ${one.held_back ? 'held back' : 'fitted'}`));
  const names = shorten_all(joints.map((one) => one.joint));
  // A log that was held back is what a reader wants to see first.
  const first = motions.filter((one) => one.held_back)[0] ?? motions[0];
  const choices: Choice[] = [
    { id: 'log', label: 'log', options: motions.map((one, i) => ({ value: one.id, label: logs[i] })), initial: first.id },
    { id: 'joint', label: 'joint', options: names.map((label, i) => ({ value: String(i), label })), initial: '0' },
  ];
  return {
    kind: 'figure',
    id: 'efforts',
    title: 'Recorded and modelled torques',
    caption:
      'The torque of a joint as it was recorded, and that of the model for the same motion, with the parameters that the robot had before and with the fitted ones. ' +
      'Below, the recorded torque minus that of each model. A model that explains everything leaves noise.',
    width: 'full',
    height: 520,
    choices,
    time: { replay: kReplay, case: (picked) => picked.log ?? first.id },
    draw: (look, picked, zoom) => draw_efforts(look, get_curves(found, { log: first.id, ...picked }), zoom),
    table: (picked) => {
      const { motion, unit, recorded, before, after } = get_curves(found, { log: first.id, ...picked });
      const columns = [recorded, before, after, subtract(recorded, before), subtract(recorded, after)];
      const rows: Value[][] = [];
      for (let k = 0; k < recorded.length; ++k) {
        rows.push([k * motion.period_s, ...columns.map((values): Value => (isFinite(values[k]) ? values[k] : null))]);
      }
      return {
        columns: [
          { label: 'time', unit: 's', numeric: true, digits: 6 },
          ...flatten([
            ['recorded', 'model before', 'model after'],
            ['residual before', 'residual after'],
          ]).map((label) => ({ label, unit, numeric: true })),
        ],
        rows,
      };
    },
  };
}
