// The design variables of the best design of each generation. They show where the optimizer
// searches and when it settles.
import { get_series_style, type Look } from '../charts/look';
import { make_number_axis, make_panel_title, make_panels, make_curve_plot } from '../charts/marks';
import { shorten } from '../charts/names';
import { make_band, make_line, type Part } from '../charts/parts';
import type { RunData, VariableHistory } from '../data';
import type { Choice, Figure, Value } from '../model';
import { flatten, format_choice, is_number, times } from './quantities';
import { name_progress } from './training';

interface Group {
  name: string;
  members: VariableHistory[];
}

const kPanelsWithoutGroups = 6;
const kColumns = 2;

// Groups variables by joint: "joint_2.p" belongs to "joint_2". Variables without such names are
// grouped in small numbers.
export function group_variables(variables: VariableHistory[]): Group[] {
  const groups: Group[] = [];
  variables.forEach((variable) => {
    const dot = variable.name.lastIndexOf('.');
    const name = dot > 0 ? variable.name.slice(0, dot) : '';
    const open = groups.filter((one) => one.name === name && (name !== '' || one.members.length < kPanelsWithoutGroups));
    const group = open[0] ?? { name, members: [] };
    if (open.length === 0) {
      groups.push(group);
    }
    group.members.push(variable);
  });
  return groups;
}

function name_group(group: Group): string {
  if (group.name !== '') {
    return shorten(group.name);
  }
  const first = shorten(group.members[0].name, 18);
  return group.members.length === 1 ? first : `${first} to ${shorten(group.members[group.members.length - 1].name, 18)}`;
}

// Returns 1 for a logarithmic axis, and -1 for a logarithmic axis of the magnitudes of negative
// values. Returns 0 for a linear axis.
export function get_log_sign(variable: VariableHistory): number {
  if (!variable.logarithmic) {
    return 0;
  }
  return variable.lower > 0 ? 1 : variable.upper < 0 ? -1 : 0;
}

function name_variable(variable: VariableHistory): string {
  const short = shorten(variable.name.slice(variable.name.lastIndexOf('.') + 1), 24);
  const name = get_log_sign(variable) < 0 ? `−${short}` : short;
  return variable.unit === '' ? name : `${name} (${shorten(variable.unit, 20)})`;
}

function draw_panel(look: Look, data: RunData, variable: VariableHistory, axis: number): Part[] {
  const sign = get_log_sign(variable) || 1;
  const x = data.training.index;
  const color = get_series_style(look, 0).color;
  const at = (values: (number | null)[]) => values.map((value, i) => [x[i], times(value, sign)] as [number, number | null]);
  const level = (name: string, value: number, dash: 'dashed' | 'dotted' | 'solid', tone: string) =>
    make_line(
      look,
      0,
      name,
      [
        [x[0], sign * value],
        [x[x.length - 1], sign * value],
      ],
      { axis, width: 1.2, style: { color: tone, dash, symbol: 'none' } },
    );
  const band: [number, number, number][] = [];
  x.forEach((index, i) => {
    const low = times(variable.q1[i], sign);
    const high = times(variable.q3[i], sign);
    if (variable.choices.length === 0 && is_number(low) && is_number(high)) {
      band.push([index, Math.min(low, high), Math.max(low, high)]);
    }
  });
  const parts = [
    make_band('quartiles of all', band, color, axis),
    make_line(look, 0, 'best', at(variable.best), { axis, width: 1.4 }),
    level('start', variable.start, 'dotted', look.text),
    level('bounds', variable.lower, 'dashed', look.bad),
    level('bounds', variable.upper, 'dashed', look.bad),
  ];
  if (is_number(variable.winner)) {
    parts.push({
      type: 'scatter',
      name: 'winner',
      data: [[x[x.length - 1], sign * variable.winner]],
      symbol: 'diamond',
      symbolSize: 11,
      clip: false,
      itemStyle: { color: get_series_style(look, 1).color, borderColor: look.background, borderWidth: 1 },
      xAxisIndex: axis,
      yAxisIndex: axis,
      z: 5,
    });
  }
  return parts;
}

// Returns the axis of a variable's values. That of a category has its words as ticks.
function make_value_axis(look: Look, variable: VariableHistory, index: number): Part {
  const axis = make_number_axis(look, 'y', '', {
    index,
    log: get_log_sign(variable) !== 0,
    values: [variable.lower, variable.upper].map(Math.abs),
  });
  if (variable.type === 'real') {
    return axis;
  }
  const formatter = (value: number) => format_choice(variable.choices, value);
  return { ...axis, minInterval: 1, axisLabel: { ...(axis.axisLabel as Part), ...(variable.choices.length > 0 ? { formatter } : {}) } };
}

export function make_variables_figure(data: RunData): Figure | null {
  if (data.variables.length === 0 || data.training.index.length === 0) {
    return null;
  }
  const groups = group_variables(data.variables);
  const choice: Choice = {
    id: 'group',
    label: groups[0].name === '' ? 'variables' : data.arm === null ? 'group' : 'joint',
    options: groups.map((group, i) => ({ value: String(i), label: name_group(group) })),
    initial: '0',
  };
  let most = 0;
  groups.forEach((group) => {
    most = Math.max(most, group.members.length);
  });
  const height = Math.ceil(most / kColumns) * 170 + 100;
  const get_group = (picked: Record<string, string>) => groups[Number(picked.group)] ?? groups[0];
  const unit = name_progress(data);
  return {
    kind: 'figure',
    id: 'variables',
    title: 'Design variables during training',
    caption:
      `The value of the best design of each ${unit === 'generation' ? 'generation' : 'block of evaluations'} (line), and the range of the ` +
      `middle half of all its designs (band). The dashed lines are the bounds, the dotted line is the start of the search, and the diamond is the winner. ` +
      `A minus sign before a name means that the variable is negative and its magnitude is drawn. ` +
      `If the band becomes narrow, the optimizer has found the value of the variable. If the line runs along a bound, a better value may be beyond it.`,
    width: 'full',
    height,
    choices: groups.length > 1 ? [choice] : undefined,
    draw: (look, picked) => {
      const group = get_group(picked);
      const count = group.members.length;
      const grids = make_panels(count, Math.min(kColumns, count), height);
      return make_curve_plot(
        look,
        group.members.map((_, i) => make_number_axis(look, 'x', i + kColumns >= count ? unit : '', { index: i, max: 'dataMax' })),
        group.members.map((variable, i) => make_value_axis(look, variable, i)),
        flatten(group.members.map((variable, i) => draw_panel(look, data, variable, i))),
        { grid: grids, title: group.members.map((variable, i) => make_panel_title(look, grids[i], name_variable(variable))) },
      );
    },
    table: (picked) => {
      const { members } = get_group(picked);
      const column = (variable: VariableHistory, what: string) => ({
        label: `${variable.name}, ${what}`,
        unit: variable.unit,
        numeric: true,
      });
      return {
        columns: [
          { label: unit, numeric: true, digits: 8 },
          ...flatten(
            members.map((variable) => ['best', 'lower quartile', 'median', 'upper quartile'].map((what) => column(variable, what))),
          ),
        ],
        rows: data.training.index.map((index, i) => [
          index as Value,
          ...flatten(members.map((one) => [one.best[i], one.q1[i], one.median[i], one.q3[i]].map((value): Value => value ?? null))),
        ]),
      };
    },
  };
}
