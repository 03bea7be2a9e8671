// Joint angles, errors and torques over time, with the limits of the torques.
import { get_series_style, type Look } from '../charts/look';
import { make_number_axis, make_curve_plot, make_stretches } from '../charts/marks';
import { shorten_all } from '../charts/names';
import { make_line, type Part, type Point } from '../charts/parts';
import type { Range } from '../charts/zoom';
import type { ReplayCase, ReplaySet, Robot } from '../data';
import type { Choice, Column, DataTable, Figure, Picked, TableItem, Value } from '../model';
import { format_number, kDegrees, kMillimetres, unpack } from '../numbers';
import { flatten, kAtLimit } from './quantities';
import {
  choose_rows,
  get_case,
  get_column,
  get_motions,
  get_time,
  kAll,
  make_case_choice,
  make_design_choice,
  take_column,
  type Moved,
} from './replay_access';

interface JointView {
  index: number;
  name: string;
  unit: string; // unit of the position
  effort_unit: string;
  factor: number; // factor from SI to that unit
}

const kStretches = 300; // the whole time divided by the shortest visible gap between two stretches

function get_joints(robot: Robot): JointView[] {
  const names = shorten_all(
    robot.joints.map((joint) => joint.name),
    24,
  );
  return robot.joints.map((joint, index) => {
    const slides = joint.kind === 'prismatic';
    return {
      index,
      name: names[index],
      unit: slides ? 'mm' : '°',
      effort_unit: slides ? 'N' : 'N m',
      factor: slides ? kMillimetres : kDegrees,
    };
  });
}

function make_joint_choice(joints: JointView[], initial: string): Choice {
  return {
    id: 'joint',
    label: 'joint',
    options: [{ value: kAll, label: 'all' }, ...joints.map((one) => ({ value: String(one.index), label: one.name }))],
    initial,
  };
}

interface View {
  one: ReplayCase;
  moved: Moved | undefined;
  joints: JointView[];
}

function get_view(set: ReplaySet, joints: JointView[], picked: Picked, initial: string): View {
  const one = get_case(set, picked);
  const wanted = picked.joint ?? initial;
  const design = picked.design ?? set.designs[0].id;
  return {
    one,
    moved: get_motions(set, one, { ...picked, design })[0],
    joints: wanted === kAll ? joints : joints.filter((joint) => String(joint.index) === wanted),
  };
}

function make_points(set: ReplaySet, values: Float32Array, zoom: Range | undefined): Point[] {
  return choose_rows(set, values, zoom).map((i) => [get_time(set, i), isFinite(values[i]) ? values[i] : null]);
}

function scaled(values: Float32Array, factor: number): Float32Array {
  const out = new Float32Array(values.length);
  for (let i = 0; i < values.length; ++i) {
    out[i] = values[i] * factor;
  }
  return out;
}

function get_angles(moved: Moved, joint: JointView, count: number): Float32Array {
  return scaled(get_column(moved.motion.q, count, joint.index), joint.factor);
}

function get_targets(one: ReplayCase, joint: JointView, count: number): Float32Array {
  return scaled(get_column(one.target_q, count, joint.index), joint.factor);
}

function get_errors(one: ReplayCase, moved: Moved, joint: JointView, count: number): Float32Array {
  const actual = get_angles(moved, joint, count);
  const target = get_targets(one, joint, count);
  const errors = new Float32Array(Math.min(actual.length, target.length));
  for (let i = 0; i < errors.length; ++i) {
    errors[i] = target[i] - actual[i];
  }
  return errors;
}

function get_unit(joints: JointView[]): string {
  const units = joints.map((joint) => joint.unit);
  return units.filter((unit, i) => units.indexOf(unit) === i).join(', ');
}

function tabulate(set: ReplaySet, columns: Column[], series: Float32Array[]): DataTable {
  let steps = 0;
  series.forEach((values) => {
    steps = Math.max(steps, values.length);
  });
  const rows: Value[][] = [];
  for (let i = 0; i < steps; ++i) {
    rows.push([get_time(set, i), ...series.map((values): Value => (i < values.length && isFinite(values[i]) ? values[i] : null))]);
  }
  return { columns: [{ label: 'time', unit: 's', numeric: true, digits: 6 }, ...columns], rows };
}

export function is_at_limit(effort: number, limits: [number, number]): boolean {
  return (limits[0] < 0 && effort <= kAtLimit * limits[0]) || (limits[1] > 0 && effort >= kAtLimit * limits[1]);
}

// Returns the stretches of time at a limit. Stretches with an invisible gap between them are
// joined.
export function find_saturated(set: ReplaySet, effort: Float32Array, limits: [number, number]): [number, number][] {
  const dt = set.task.control_period_s;
  const found: [number, number][] = [];
  const close = (effort.length * dt) / kStretches;
  for (let i = 0; i < effort.length; ++i) {
    if (!is_at_limit(effort[i], limits)) {
      continue;
    }
    const last = found[found.length - 1];
    if (last !== undefined && i * dt - last[1] <= close) {
      last[1] = (i + 1) * dt;
    } else {
      found.push([i * dt, (i + 1) * dt]);
    }
  }
  return found;
}

function get_share(effort: Float32Array, limits: [number, number]): number {
  let count = 0;
  for (let i = 0; i < effort.length; ++i) {
    count += is_at_limit(effort[i], limits) ? 1 : 0;
  }
  return effort.length === 0 ? 0 : (100 * count) / effort.length;
}

function draw_torques(look: Look, set: ReplaySet, view: View, count: number, zoom: Range | undefined) {
  const series: Part[] = [];
  const single = view.joints.length === 1 ? view.joints[0] : null;
  const { moved } = view;
  if (moved !== undefined) {
    view.joints.forEach((joint) => {
      const limits = moved.design.effort_limits[joint.index];
      const effort = get_column(moved.motion.effort, count, joint.index);
      const share = limits ? `, ${format_number(get_share(effort, limits), 2)} % at a limit` : '';
      const name = `${joint.name}${share}`;
      if (single) {
        series.push(make_line(look, joint.index, name, make_points(set, effort, zoom), { width: 1.2 }));
        if (limits) {
          const end = get_time(set, view.one.steps - 1);
          limits.forEach((limit) => {
            const style = { color: look.bad, dash: 'dashed' as const, symbol: 'none' };
            series.push(
              make_line(
                look,
                0,
                'limits',
                [
                  [0, limit],
                  [end, limit],
                ],
                { width: 1.2, style },
              ),
            );
          });
          const stretches = find_saturated(set, effort, limits);
          if (stretches.length > 0) {
            series.push(make_stretches(look, stretches, look.bad, 0, 0.25));
          }
        }
      } else {
        const relative = new Float32Array(effort.length);
        for (let i = 0; i < effort.length; ++i) {
          const limit = limits ? Math.abs(effort[i] < 0 ? limits[0] : limits[1]) : NaN;
          relative[i] = (100 * effort[i]) / limit;
        }
        series.push(make_line(look, joint.index, name, make_points(set, relative, zoom), { width: 1.2 }));
      }
    });
  }
  return make_curve_plot(
    look,
    make_number_axis(look, 'x', 'time (s)', { min: 0, max: 'dataMax' }),
    make_number_axis(
      look,
      'y',
      single ? `${single.effort_unit === 'N' ? 'force' : 'torque'} (${single.effort_unit})` : 'torque (% of its limit)',
      {},
      { nameGap: 54, boundaryGap: ['4%', '4%'] },
    ),
    series,
    { grid: { left: 78, right: 24, top: 44, bottom: 48 } },
  );
}

export function make_joint_figures(set: ReplaySet, robot: Robot | undefined): Figure[] {
  if (set.cases.length === 0 || set.designs.length === 0 || robot === undefined || robot.joints.length === 0) {
    return [];
  }
  const joints = get_joints(robot);
  const count = joints.length;
  const torque_initial = '0';
  const choices = (initial: string) => [make_case_choice(set), make_design_choice(set, false), make_joint_choice(joints, initial)];
  const time = { replay: set.id, case: (picked: Picked) => get_case(set, picked).id };
  const x_axis = (look: Look) => make_number_axis(look, 'x', 'time (s)', { min: 0, max: 'dataMax' });

  const angles: Figure = {
    kind: 'figure',
    id: 'joint-angles',
    title: 'Joint angles',
    caption:
      'The angles of the joints (solid lines) and the angles that the inverse kinematics of the target asks for (dotted lines), over a whole case. ' +
      'If the two lines coincide, the controllers follow. The figure of the joint errors shows the difference.',
    width: 'full',
    choices: choices(kAll),
    time,
    draw: (look, picked, zoom) => {
      const view = get_view(set, joints, picked, kAll);
      const { moved } = view;
      const series = flatten(
        view.joints.map((joint) => {
          const style = get_series_style(look, joint.index);
          const target = make_line(
            look,
            joint.index,
            `${joint.name}, target`,
            make_points(set, get_targets(view.one, joint, count), zoom),
            {
              width: 2.2,
              style: { ...style, dash: 'dotted' },
            },
          );
          return moved === undefined
            ? [target]
            : [make_line(look, joint.index, joint.name, make_points(set, get_angles(moved, joint, count), zoom), { width: 1.2 }), target];
        }),
      );
      return make_curve_plot(look, x_axis(look), make_number_axis(look, 'y', `position (${get_unit(view.joints)})`), series);
    },
    table: (picked) => {
      const view = get_view(set, joints, picked, kAll);
      const { moved } = view;
      return tabulate(
        set,
        flatten(
          view.joints.map((joint): Column[] => [
            { label: joint.name, unit: joint.unit, numeric: true },
            { label: `${joint.name}, target`, unit: joint.unit, numeric: true },
          ]),
        ),
        flatten(
          view.joints.map((joint) => [moved ? get_angles(moved, joint, count) : new Float32Array(0), get_targets(view.one, joint, count)]),
        ),
      );
    },
  };

  const errors: Figure = {
    kind: 'figure',
    id: 'joint-errors',
    title: 'Joint errors',
    caption:
      'The error that the controller of each joint gets, over a whole case: the angle that the inverse kinematics of the target asks for, minus the angle of the joint. ' +
      'A constant error during a rest is one that the integral term has not yet removed.',
    width: 'full',
    choices: choices(kAll),
    time,
    draw: (look, picked, zoom) => {
      const view = get_view(set, joints, picked, kAll);
      const { moved } = view;
      const series =
        moved === undefined
          ? []
          : view.joints.map((joint) =>
              make_line(look, joint.index, joint.name, make_points(set, get_errors(view.one, moved, joint, count), zoom), { width: 1.2 }),
            );
      return make_curve_plot(look, x_axis(look), make_number_axis(look, 'y', `error (${get_unit(view.joints)})`), series);
    },
    table: (picked) => {
      const view = get_view(set, joints, picked, kAll);
      const { moved } = view;
      return tabulate(
        set,
        view.joints.map((joint) => ({ label: joint.name, unit: joint.unit, numeric: true })),
        moved ? view.joints.map((joint) => get_errors(view.one, moved, joint, count)) : view.joints.map(() => new Float32Array(0)),
      );
    },
  };

  const torques: Figure = {
    kind: 'figure',
    id: 'joint-torques',
    title: 'Joint torques',
    caption:
      'The torque of the chosen joint over a whole case. The dashed lines are its limits, which the design sets. In shaded times the torque is at a limit, so the controller has no effect. ' +
      'With all joints together, the figure shows the torque as a share of the limit in its direction. The legend has the share of the control periods in which a joint is at a limit.',
    width: 'full',
    choices: choices(torque_initial),
    time,
    draw: (look, picked, zoom) => draw_torques(look, set, get_view(set, joints, picked, torque_initial), count, zoom),
    table: (picked) => {
      const view = get_view(set, joints, picked, torque_initial);
      const { moved } = view;
      return tabulate(
        set,
        view.joints.map((joint) => ({ label: joint.name, unit: joint.effort_unit, numeric: true })),
        moved
          ? view.joints.map((joint) => get_column(moved.motion.effort, count, joint.index))
          : view.joints.map(() => new Float32Array(0)),
      );
    },
  };
  return [angles, errors, torques];
}

// Returns the share of time for which each joint of each design is at its limits.
function tabulate_saturation(set: ReplaySet, joints: JointView[]): Value[][] {
  const rows: Value[][] = [];
  set.cases.forEach((one) => {
    get_motions(set, one, {}).forEach((moved) => {
      const all = unpack(moved.motion.effort);
      joints.forEach((joint) => {
        const limits = moved.design.effort_limits[joint.index];
        if (limits === undefined) {
          return;
        }
        const effort = take_column(all, joints.length, joint.index);
        let low = 0;
        let high = 0;
        for (let i = 0; i < effort.length; ++i) {
          low = Math.min(low, effort[i]);
          high = Math.max(high, effort[i]);
        }
        rows.push([one.label, moved.design.name, joint.name, low, limits[0], high, limits[1], get_share(effort, limits)]);
      });
    });
  });
  return rows;
}

export function make_saturation_table(set: ReplaySet, robot: Robot | undefined): TableItem | null {
  if (robot === undefined || robot.joints.length === 0 || set.cases.length === 0) {
    return null;
  }
  const joints = get_joints(robot);
  const column = (label: string, unit: string) => ({ label, unit, numeric: true });
  const unit = joints.every((joint) => joint.effort_unit === 'N m') ? 'N m' : 'N m, N';
  let made: DataTable | null = null;
  return {
    kind: 'table',
    id: 'saturation',
    title: 'Torques and their limits',
    caption:
      'The largest torques of each joint in the recorded cases, its limits, and the share of the control periods in which it is at a limit.',
    // The table is made only on request, because every motion must be unpacked for it.
    get table(): DataTable {
      made = made ?? {
        columns: [
          { label: 'case' },
          { label: 'design' },
          { label: 'joint' },
          column('smallest', unit),
          column('lower limit', unit),
          column('largest', unit),
          column('upper limit', unit),
          column('at a limit', '% of the time'),
        ],
        rows: tabulate_saturation(set, joints),
      };
      return made;
    },
  };
}
