// The parts of the replay that need no browser, in particular that the page's arm moves as the
// simulated one does: data/kinematics.json was computed by it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import { load } from './load.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const source = join(here, '../src/replay');
const parts = ['chain', 'timeline', 'colours', 'scenario', 'load'].map((name) => `export * from './${name}';`).join('\n');
const bundle = await build({
  stdin: { contents: parts, resolveDir: source, loader: 'ts' },
  bundle: true,
  format: 'esm',
  target: 'es2020',
  write: false,
});
const { kDark, kLight } = await load(`export { kDark, kLight } from './src/charts/look';`);
const replay = await import(`data:text/javascript;base64,${Buffer.from(bundle.outputFiles[0].contents).toString('base64')}`);

const robots = JSON.parse(readFileSync(join(here, 'data/kinematics.json'), 'utf8'));

function assert_near(values, expected, tolerance) {
  assert.equal(values.length, expected.length);
  values.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) <= tolerance, `${i}: ${value} is not ${expected[i]}`));
}

const pack = (values) => ({ f32: Buffer.from(new Float32Array(values).buffer).toString('base64') });

for (const { robot, postures } of robots) {
  test(`the links of ${robot.name} are where the simulation has them`, () => {
    assert.ok(postures.length > 0);
    const chain = replay.make_chain(robot);
    for (const { q, links, tip } of postures) {
      const frames = replay.calc_frames(chain, q);
      assert.equal(frames.length, links.length + 1);
      assert.deepEqual(frames[0], replay.kIdentity);
      links.forEach((link, i) => assert_near(frames[i + 1], link, 1e-14));
      assert_near(replay.calc_tip(chain, [9, 9, ...q], 2), tip, 1e-14);
    }
  });
}

const segments = [
  { first_step: 0, steps: 30, window_start: 20, distance_m: 0.1, duration_s: 0.2 },
  { first_step: 30, steps: 50, window_start: 25, distance_m: 0.3, duration_s: 0.25 },
  { first_step: 80, steps: 20, window_start: 20, distance_m: 0.2, duration_s: 0.2 },
];

test('a moment belongs to the segment whose control period ends in it', () => {
  const found = [0, 1, 29, 30, 31, 80, 81, 100].map((moment) => replay.find_segment(segments, moment));
  assert.deepEqual(found, [0, 0, 0, 0, 1, 1, 2, 2]);
  assert.equal(replay.find_segment([], 5), 0);
});

test('times that are sums of periods are whole moments', () => {
  let time = 0;
  for (let moment = 0; moment <= 5000; ++moment) {
    assert.equal(replay.find_moment(time, 0.01, 5000), moment);
    time += 0.01;
  }
  assert.equal(replay.find_moment(0.019, 0.01, 5000), 1);
  assert.equal(replay.find_moment(60, 0.01, 5000), 5000);
  assert.equal(replay.find_moment(-1, 0.01, 5000), 0);
});

test('steps from point to point stop at each of them once', () => {
  const forward = [];
  for (let moment = 0; moment < 100;) {
    moment = replay.find_next_point(segments, moment, 100);
    forward.push(moment);
  }
  assert.deepEqual(forward, [30, 80, 100]);
  const back = [];
  for (let moment = 95; moment > 0;) {
    moment = replay.find_previous_point(segments, moment);
    back.push(moment);
  }
  assert.deepEqual(back, [80, 30, 0]);
});

test('a measured window begins with the row that it names', () => {
  const measured = [20, 21, 30, 31].map((moment) => replay.is_measured(segments[0], moment));
  assert.deepEqual(measured, [false, true, true, false]);
  assert.equal(replay.is_measured(segments[2], 100), false);
});

test('between two rows the joints go straight, before the first from the start', () => {
  const rows = [1, 10, 3, 30];
  assert.deepEqual(replay.interpolate_row(rows, 2, 2, [0, 0], 0), [0, 0]);
  assert.deepEqual(replay.interpolate_row(rows, 2, 2, [0, 0], 0.5), [0.5, 5]);
  assert.deepEqual(replay.interpolate_row(rows, 2, 2, [0, 0], 1), [1, 10]);
  assert.deepEqual(replay.interpolate_row(rows, 2, 2, [0, 0], 1.25), [1.5, 15]);
  assert.deepEqual(replay.interpolate_row(rows, 2, 2, [0, 0], 7), [3, 30]);
});

test('a colour scale has whole decades, four at most, and ends at a metre', () => {
  const limits = (errors) => {
    const scale = replay.make_colour_scale([errors], 'light');
    return [scale.lower_m, scale.upper_m].map((value) => Number(value.toPrecision(6)));
  };
  assert.deepEqual(limits([0.0002, 0.004, 0.03]), [0.0001, 0.1]);
  assert.deepEqual(limits([0.01, 0.001]), [0.001, 0.01]);
  assert.deepEqual(limits([0, 0.02]), [0.00001, 0.1]);
  assert.deepEqual(limits([0, 900]), [0.0001, 1]);
  assert.deepEqual(limits([]), limits([0]));
});

test('colours are ordered by lightness, away from the background', () => {
  const lightness = ([r, g, b]) => 0.2126 * Math.pow(r, 2.2) + 0.7152 * Math.pow(g, 2.2) + 0.0722 * Math.pow(b, 2.2);
  for (const theme of ['light', 'dark']) {
    const scale = replay.make_colour_scale([[0.0001, 0.1]], theme);
    const values = [0, 0.2, 0.4, 0.6, 0.8, 1].map((share) => lightness(replay.find_colour(scale, 0.0001 * Math.pow(1000, share))));
    for (let i = 1; i < values.length; ++i) {
      assert.ok(theme === 'light' ? values[i] < values[i - 1] : values[i] > values[i - 1], `${theme} ${values}`);
    }
    assert.deepEqual(replay.find_colour(scale, 0), scale.stops[0]);
    assert.deepEqual(replay.find_colour(scale, 5), scale.stops[scale.stops.length - 1]);
    assert_near([replay.find_share(scale, Math.sqrt(0.0001 * 0.1))], [0.5], 1e-12);
    assert.equal(replay.list_decades(scale).length, 4);
  }
});

test('links are painted by the share of the torque limit on its side, and by the way to the end of the range', () => {
  const joints = [
    { lower: -1, upper: 3 },
    { lower: -2, upper: 2 },
    { lower: null, upper: null },
  ];
  const limits = [
    [-10, 40],
    [-10, 40],
    [null, null],
  ];
  const track = { count: 2, limits, effort: Float32Array.from([0, 0, 0, 10, -10, 7]) };
  const scenario = { chain: { robot: { joints } } };
  const shares = (moment, paint) => replay.find_shares(scenario, track, moment, [1, 1.9, 5], paint);
  assert.deepEqual(shares(2, 'torque'), [0.25, 1, null]);
  assert.deepEqual(shares(0, 'torque'), [null, null, null]);
  assert.deepEqual(shares(3, 'torque'), [null, null, null]);
  const [middle, near, free] = shares(2, 'position');
  assert_near([middle, near], [0, 0.95], 1e-12);
  assert.equal(free, null);
  assert.deepEqual([0.254, 1, 1.01, null].map(replay.describe_share), ['25 %', 'at the limit', 'at the limit', '–']);
});

test('the colours of links are ordered by lightness, and a limit has the colour of what is bad', () => {
  for (const look of [kLight, kDark]) {
    for (const [paint, shares] of Object.entries({ torque: [0, 0.1, 0.3, 0.99], position: [0.49, 0.5, 0.8, 0.99] })) {
      const at = shares.map((share) => replay.find_colour_of(share, look, paint));
      const lightness = at.map((colour) => [1, 3, 5].reduce((sum, i) => sum + parseInt(colour.slice(i, i + 2), 16), 0));
      const sorted = lightness.slice().sort((a, b) => (look === kLight ? b - a : a - b));
      assert.deepEqual(lightness, sorted);
      assert.equal(new Set(at).size, 4);
      assert.equal(replay.find_colour_of(1, look, paint), look.bad);
      assert.equal(replay.find_colour_of(null, look, paint), look.muted);
      assert.deepEqual(
        replay.list_paints(look, paint).map((one) => one.colour),
        [...at, look.bad],
      );
    }
  }
});

test('a motion that broke off has no error afterwards and says why', () => {
  const { robot, postures } = robots[0];
  const start_q = postures[0].q;
  const motion = {
    design: 'base',
    status: 'diverged',
    reason: 'the tip is 2 m off',
    steps: 2,
    mean_error_m: null,
    point_error_m: [],
    q: pack([...postures[1].q, ...postures[2].q]),
    effort: pack([]),
    error_m: pack([0.25, 0.5]),
  };
  const tip = postures[0].tip;
  const one_case = {
    id: 'test:1',
    label: 'test, case 1',
    set: 'test',
    number: 1,
    points_m: [
      [tip[0], tip[1], tip[2] + 0.125],
      [1, 0, 1],
    ],
    segments: [{ first_step: 0, steps: 4, window_start: 2, distance_m: 1, duration_s: 0.02 }],
    steps: 4,
    target_m: pack([1, 0, 1, 1, 0, 2, 1, 0, 3, 1, 0, 4]),
    target_q: pack([]),
    start_q,
    motions: [motion],
  };
  const set = {
    id: 's',
    title: 's',
    robot: 0,
    task: { control_period_s: 0.01 },
    designs: [{ id: 'base', name: 'base controllers' }],
    cases: [one_case],
  };
  const scenario = replay.make_scenario(set, one_case, robot);
  const [track] = scenario.tracks;
  assert.equal(track.name, 'base controllers');
  assert_near(
    [0, 1, 2].map((moment) => replay.find_error(track, moment)),
    [0.125, 0.25, 0.5],
    1e-7,
  );
  assert.equal(replay.find_error(track, 3), null);
  assert_near(Array.from(track.tip_m.subarray(6, 9)), postures[2].tip, 1e-5);
  assert_near(replay.find_q(scenario, track, 4), postures[2].q, 1e-6);
  assert_near(replay.find_target(scenario, 2.5), [1, 0, 2.5], 1e-6);
  assert.equal(replay.describe_end(motion, one_case, 1, 0.01), '');
  assert.equal(replay.describe_end(motion, one_case, 2, 0.01), 'diverged at 0.02 s: the tip is 2 m off');
});

test('a motion that a robot recorded has no target and no errors, and its picture holds the whole path', () => {
  const { robot, postures } = robots[0];
  const [first, ...others] = postures;
  const motion = {
    design: 'recorded',
    status: 'ok',
    reason: '',
    steps: others.length,
    mean_error_m: null,
    point_error_m: [],
    q: pack(others.flatMap((one) => one.q)),
    effort: pack([]),
    error_m: pack([]),
  };
  const nothing = pack([]);
  const one_case = {
    ...{ id: 'log-1', label: 'a.csv, fitted', set: 'logs', number: 0, points_m: [], segments: [], steps: others.length },
    ...{ target_m: nothing, target_q: nothing, start_q: first.q, motions: [motion] },
  };
  const set = { id: 'recorded', title: '', robot: 0, task: { control_period_s: 0.04 }, designs: [], cases: [one_case] };
  const scenario = replay.make_scenario(set, one_case, robot);
  assert.equal(scenario.is_recorded, true);
  assert.equal(replay.find_target(scenario, 1), null);
  const [track] = scenario.tracks;
  assert.equal(track.count, others.length);
  assert.ok(track.errors_m.every((error) => error === 0));
  assert.equal(scenario.places_m.length, postures.length);
  postures.forEach((one, i) => assert_near(scenario.places_m[i], one.tip, 1e-5));
  assert_near(replay.find_q(scenario, track, 0), first.q, 1e-6);
});
