// The first screen of a run's page: tiles with the run's result and effort, and the health card of
// the winner. A sign and a word repeat the meaning of each colour.
import { join_names, shorten } from '../charts/names';
import type { CheckedSetting, Health, HealthGrade, JointHealth, MoveHealth, RunData } from '../data';
import type { GradeLine, SummaryItem, Tile } from '../model';
import { format_duration, format_number, kMillimetres } from '../numbers';
import { count_of, get_shown, is_number } from './quantities';

const kStates: { [grade in HealthGrade]: { state: string; mark: GradeLine['mark'] } } = {
  good: { state: '✓ good', mark: 'good' },
  watch: { state: '! watch', mark: 'near' },
  bad: { state: '✗ bad', mark: 'bad' },
};
const kUngraded = { state: '– not graded', mark: 'none' as const };
const kUnmeasured = { state: '? not measured', mark: 'none' as const };
const kUnchecked = { state: '? not checked', mark: 'none' as const };
const kMostNames = 6; // in one line

// Returns a share as "12 %".
function percent(share: number, digits = 2): string {
  return format_number(100 * share, digits) + ' %';
}

function join_some(texts: string[]): string {
  const left = texts.length - kMostNames;
  return texts.slice(0, kMostNames).join(', ') + (left > 0 ? ` and ${left} more` : '');
}

// ---------------------------------------------------------------- tiles

function find_row(data: RunData, id: string) {
  return data.arm === null ? undefined : data.arm.results.filter((row) => row.design === id)[0];
}

// Returns "base controllers" or another name of the design from which the run started.
function get_base_name(data: RunData): string {
  const base = data.arm === null ? undefined : data.arm.designs.filter((design) => design.id === 'base')[0];
  return base === undefined ? '' : shorten(base.name);
}

function compare(before: number, after: number): string {
  if (!(before > 0 && after > 0)) {
    return '';
  }
  const factor = format_number(Math.max(before / after, after / before), 3);
  return Number(factor) === 1 ? 'unchanged: ' : `${after < before ? 'better' : 'worse'} by a factor of ${factor}: `;
}

// Returns a label that begins with a capital letter, unless it is a symbol such as "f".
function capitalize(name: string): string {
  return name.length < 3 ? name : name.charAt(0).toUpperCase() + name.slice(1);
}

function make_value_tile(data: RunData): Tile | null {
  const { value, quantity, test_cases } = data.headline;
  if (!is_number(value) || quantity === null) {
    return null;
  }
  const shown = get_shown(quantity);
  const text = (number: number): string => format_number(number * shown.factor, 3);
  const unit = shown.unit === '' || shown.unit === '1' ? '' : ' ' + shown.unit;
  const set = data.test === null ? '' : shorten(data.test.set);
  const where = test_cases === null ? 'of the winner' : `on ${count_of(test_cases, 'case')} of ${set}`;
  const before = find_row(data, 'base')?.mean_m;
  if (test_cases === null || !is_number(before)) {
    return { label: capitalize(shown.name), value: text(value) + unit, detail: where };
  }
  return {
    label: capitalize(shown.name),
    value: `${text(before)} → ${text(value)}${unit}`,
    detail: `${compare(before, value)}${get_base_name(data)} → winner, ${where}`,
  };
}

function make_failure_tile(data: RunData): Tile | null {
  const { failures, test_cases } = data.headline;
  if (failures === null || test_cases === null) {
    return null;
  }
  const limit = data.test === null ? null : data.test.failure_error;
  return {
    label: 'Failed test cases',
    value: `${failures > 0 ? '✗' : '✓'} ${failures} of ${test_cases}`,
    detail: is_number(limit) ? `error above ${format_number(limit * kMillimetres)} mm, or no result` : '',
    mark: failures > 0 ? 'bad' : 'good',
  };
}

// Returns the tiles of the errors beside those at rest, as far as they were measured.
function make_motion_tiles(data: RunData): Tile[] {
  const { motion } = data.headline;
  if (motion === null) {
    return [];
  }
  const millimetres = (error_m: number): string => format_number(error_m * kMillimetres, 3) + ' mm';
  const moving: Tile = {
    label: 'Error while moving',
    value: `RMS ${millimetres(motion.error_while_moving_rms_m)}`,
    detail: `peak ${millimetres(motion.error_while_moving_peak_m)}; distance to the moving target`,
  };
  const start = motion.error_after_start_up_m;
  return start === null
    ? [moving]
    : [moving, { label: 'Error after start-up', value: `up to ${millimetres(start)}`, detail: "until the target's first rest ends" }];
}

function make_effort_tile(data: RunData, label: string, key: 'total_torque_n_m' | 'total_force_n', unit: string): Tile | null {
  const total = data.headline[key];
  if (!is_number(total)) {
    return null;
  }
  const before = find_row(data, 'base')?.[key];
  const joints =
    key === 'total_force_n' ? 'the joints that slide' : data.headline.total_force_n === null ? 'all joints' : 'the joints that turn';
  return {
    label,
    value: `${format_number(total)} ${unit}`,
    detail: is_number(before) ? `${get_base_name(data)}: ${format_number(before)} ${unit}` : `sum of the effort limits of ${joints}`,
  };
}

// The time that the run took and when it started, as far as they are recorded.
function make_time_tile(data: RunData): Tile | null {
  const { started, times } = data.headline;
  const found = /^(\d{4}-\d\d-\d\d)T(\d\d:\d\d)/.exec(started);
  if (times === null) {
    return found === null ? null : { label: 'Started', value: found[1], detail: found[2] + ' UTC' };
  }
  const details = [times.cpu_s === null ? 'processor time unknown' : format_duration(times.cpu_s) + ' of processor time'];
  if (times.lives > 1) {
    details.push(`in ${times.lives} parts`);
  }
  if (found !== null) {
    details.push(`started ${found[1]}, ${found[2]} UTC`);
  }
  return { label: 'Time taken', value: format_duration(times.wall_s), detail: details.join('; ') };
}

function make_tiles(data: RunData): Tile[] {
  const { cases, evaluations } = data.headline;
  const tiles: (Tile | null)[] = [
    make_value_tile(data),
    ...make_motion_tiles(data),
    make_failure_tile(data),
    make_effort_tile(data, 'Total torque', 'total_torque_n_m', 'N m'),
    make_effort_tile(data, 'Total force', 'total_force_n', 'N'),
    {
      label: data.arm === null ? 'Evaluated cases' : 'Simulations',
      value: String(cases),
      detail: `of ${data.training.budget} in the budget, in ${count_of(evaluations, 'evaluation')}`,
    },
    make_time_tile(data),
  ];
  return tiles.filter((tile): tile is Tile => tile !== null);
}

export function make_tiles_item(data: RunData): SummaryItem {
  const { faults } = data.headline;
  const verdict = faults.length > 0 ? { text: `✗ Do not use this design: ${faults.join('; ')}.`, mark: 'bad' as const } : undefined;
  return { kind: 'summary', id: 'tiles', title: '', ...(verdict === undefined ? {} : { verdict }), tiles: make_tiles(data), lines: [] };
}

// ---------------------------------------------------------------- health

// A line, and what it says in the verdict if it is not good.
interface Judged extends GradeLine {
  complaint: string;
}

const kOrder: HealthGrade[] = ['good', 'watch', 'bad'];

function find_worst(grades: (HealthGrade | null)[]): HealthGrade | null {
  const places = grades.filter((grade): grade is HealthGrade => grade !== null).map((grade) => kOrder.indexOf(grade));
  return places.length === 0 ? null : kOrder[Math.max(...places)];
}

function judge(name: string, grade: HealthGrade | null, value: string, meaning: string, complaint: string): Judged {
  const { state, mark } = grade === null ? kUnmeasured : kStates[grade];
  const is_fine = grade === null || grade === 'good';
  return { name, state, mark, value, meaning: is_fine ? '' : meaning, complaint: is_fine ? '' : complaint };
}

function inform(name: string, value: string): Judged {
  return { name, ...(value === '' ? kUnmeasured : kUngraded), value, meaning: '', complaint: '' };
}

function name_all(joints: JointHealth[]): string {
  return join_names(joints.map((joint) => shorten(joint.name, 24)));
}

// Returns "12 %" for one share, "up to 12 %" for several.
function up_to(shares: (number | null)[]): string {
  return (shares.length > 1 ? 'up to ' : '') + percent(Math.max(...shares.filter(is_number)));
}

// Returns "joint_1 2 %, joint_2 0 %". Joints without a number are left out.
function list_joints(joints: JointHealth[], get: (joint: JointHealth) => string | null): string {
  const texts: string[] = [];
  joints.forEach((joint) => {
    const text = get(joint);
    if (text !== null) {
      texts.push(`${shorten(joint.name, 24)} ${text}`);
    }
  });
  return join_some(texts);
}

function judge_saturation(health: Health): Judged {
  const { joints } = health;
  const worst = find_worst(joints.map((joint) => joint.saturation));
  const found = joints.filter((joint) => joint.saturation === worst);
  return judge(
    'Saturation, share of the time',
    worst,
    list_joints(joints, (joint) => (is_number(joint.saturated_share) ? percent(joint.saturated_share) : null)),
    'The controller wants more than the effort limit allows. Raise the limit or lower the speed.',
    `${name_all(found)} ${found.length === 1 ? 'is' : 'are'} at an effort limit ${up_to(found.map((joint) => joint.saturated_share))} of the time`,
  );
}

function judge_ripple(health: Health): Judged {
  const { joints } = health;
  const worst = find_worst(joints.map((joint) => joint.ripple));
  const found = joints.filter((joint) => joint.ripple === worst);
  const describe = (joint: JointHealth): string | null =>
    is_number(joint.ripple_share)
      ? percent(joint.ripple_share) + (is_number(joint.ripple_hz) ? ` at ${format_number(joint.ripple_hz, 2)} Hz` : '')
      : null;
  return judge(
    `Oscillation above ${health.ripple_floor_hz} Hz, share of the limit`,
    worst,
    list_joints(joints, describe),
    'Fast changes of the effort wear gears and heat motors. Lower the gains or shorten the control period.',
    `the effort of ${name_all(found)} oscillates by ${up_to(found.map((joint) => joint.ripple_share))} of its limit`,
  );
}

function judge_bounds(health: Health): Judged {
  const { grade, near, nearest } = health.bounds;
  const list = join_some(nearest.map((one) => `${shorten(one.name)} ${percent(Math.max(0, one.distance))} from its ${one.bound} bound`));
  return judge(
    'Variables near a bound, share of the range',
    nearest.length === 0 ? null : grade,
    near > 0 ? list : nearest.length === 0 ? '' : `none; the nearest is ${list}`,
    'The best value may be beyond the bound. Widen the bounds and run again.',
    `${near === 1 ? '1 variable is' : near + ' variables are'} near a bound`,
  );
}

// Judges the settings of the check together, by the worst. A setting that was not simulated leaves the
// check incomplete.
function judge_check({ check }: Health): Judged {
  const name = 'Under other conditions';
  if (check === null) {
    return {
      name,
      ...kUnchecked,
      value: '',
      meaning: 'The command that began the run checks the winner, and armwright verify checks more.',
      complaint: '',
    };
  }
  const with_outcome = (settings: CheckedSetting[]): string =>
    settings.map((one) => `${shorten(one.outcome)} with ${shorten(one.name)}`).join('; ');
  const fine = check.settings.filter((one) => one.grade === 'good');
  const others = check.settings.filter((one) => one.grade !== 'good');
  const complaints = check.settings.filter((one) => one.grade === 'bad' || one.grade === 'watch');
  const works = fine.length === 0 ? '' : `works with ${join_names(fine.map((one) => shorten(one.name)))}`;
  const value = [with_outcome(others), works].filter((text) => text !== '').join('; ');
  if (complaints.length === 0 && others.length > 0) {
    return { name, ...kUnchecked, value, meaning: shorten(others[0].reason, 200), complaint: '' };
  }
  return judge(
    name,
    find_worst(check.settings.map((one) => one.grade)),
    value,
    'A real arm differs from the simulation in such ways. Tune with these conditions in training.',
    with_outcome(complaints),
  );
}

// Returns no line for a problem without constraints.
function judge_constraints({ constraints }: Health): Judged[] {
  if (constraints === null) {
    return [];
  }
  const { grade, violated } = constraints;
  const list = join_some(violated.map((name) => shorten(name)));
  return [
    judge(
      'Constraints on the test set',
      grade,
      grade === null ? 'a case has no number' : violated.length > 0 ? `violated: ${list}` : 'met',
      'Run again with a larger budget, or state weaker limits.',
      `it violates ${list}`,
    ),
  ];
}

function describe_settling(moves: MoveHealth): string {
  const seconds = (time_s: number): string => format_number(time_s, 2) + ' s';
  const times = `median ${seconds(moves.settling_median_s)}, longest ${seconds(moves.settling_largest_s)}`;
  return times + (moves.unsettled > 0 ? `; ${moves.unsettled} of ${moves.count} moves end before the tip has settled` : '');
}

function judge_all(health: Health): Judged[] {
  const { moves, joints } = health;
  return [
    judge(
      'Failed test cases',
      health.failing,
      `${health.failures} of ${health.cases}`,
      'The tab Response lists them with their reasons.',
      `${health.failures} of ${count_of(health.cases, 'test case')} failed`,
    ),
    ...judge_constraints(health),
    judge_check(health),
    judge_saturation(health),
    judge_ripple(health),
    judge_bounds(health),
    inform(
      'Margin to the effort limits',
      list_joints(joints, (joint) => (is_number(joint.used_share) ? percent(Math.max(0, 1 - joint.used_share)) : null)),
    ),
    inform(
      'Overshoot, share of the move',
      moves === null ? 'no move that counts' : `median ${percent(moves.overshoot_median)}, largest ${percent(moves.overshoot_largest)}`,
    ),
    inform(
      moves === null ? 'Settling time' : `Settling to ${percent(moves.settling_band)} of the move`,
      moves === null ? 'no move that counts' : describe_settling(moves),
    ),
  ];
}

function make_verdict(lines: Judged[]): NonNullable<SummaryItem['verdict']> {
  const list = (mark: GradeLine['mark']): string =>
    lines
      .filter((line) => line.mark === mark)
      .map((line) => line.complaint)
      .join('; ');
  const bad = list('bad');
  const near = list('near');
  const missing = lines.filter((line) => line.state === kUnmeasured.state || line.state === kUnchecked.state);
  const rest = missing.length === 0 ? '' : ` Not checked: ${missing.map((line) => line.name).join('; ')}.`;
  if (bad !== '') {
    return { text: `✗ The winner is not healthy: ${bad}.${near === '' ? '' : ` Watch: ${near}.`}${rest}`, mark: 'bad' };
  }
  if (near !== '') {
    return { text: `! Nothing about the winner is bad, but watch: ${near}.${rest}`, mark: 'near' };
  }
  return rest === ''
    ? { text: '✓ The winner is healthy.', mark: 'good' }
    : { text: `? Nothing about the winner is bad as far as it was checked.${rest}`, mark: 'none' };
}

// Returns a sentence about the check, or an empty text without one.
function describe_check({ check }: Health): string {
  const limit = check === null ? '' : format_number(check.limit_m * kMillimetres, 3);
  return check === null
    ? ''
    : ` Other conditions were simulated on the first ${count_of(check.cases, 'case')}: a mean error up to ${limit} mm works, and one failed case is bad.`;
}

export function make_health_item(health: Health): SummaryItem {
  const lines = judge_all(health);
  const { saturation, ripple, bound } = health.limits;
  const both = (limits: [number, number]): string => `${100 * limits[0]} and ${100 * limits[1]} %`;
  return {
    kind: 'summary',
    id: 'health',
    title: 'Health of the winner',
    verdict: make_verdict(lines),
    tiles: [],
    lines: lines.map(({ name, state, mark, value, meaning }) => ({ name, state, mark, value, meaning })),
    caption:
      `Failures and saturation are those of all cases of ${shorten(health.set)}. Oscillation, margin, overshoot and settling are those of ` +
      `${shorten(health.case)}, the median case by error. "Watch" and "bad" begin at ${both(saturation)} of the time in saturation and at ` +
      `an oscillation with an RMS of ${both(ripple)} of the effort limit. A variable within ${100 * bound} % of a bound is worth watching.` +
      describe_check(health),
  };
}
