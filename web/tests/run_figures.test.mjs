// The figures of a run and of the repeated thesis, on made-up data.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const {
  choose_rows,
  describe_progress,
  draw_svg,
  find_saturated,
  get_initial_picks,
  group_variables,
  kDark,
  kLight,
  make_histogram,
  make_identification_data,
  make_page,
  make_replay_set,
  make_reproduction_data,
  make_run_data,
  read_signals,
} = await load(`
  export { draw_svg, get_initial_picks } from './src/charts/svg';
  export { kDark, kLight } from './src/charts/look';
  export { describe_progress } from './src/figures/watched';
  export { make_page } from './src/figures/page';
  export { find_saturated } from './src/figures/joints';
  export { choose_rows } from './src/figures/replay_access';
  export { make_histogram } from './src/figures/test_errors';
  export { read_signals } from './src/figures/winner';
  export { group_variables } from './src/figures/variables';
  export { make_identification_data } from './tests/fixtures/identification';
  export { make_replay_set, make_reproduction_data, make_run_data } from './tests/fixtures/pages';
`);

const get_items = (data) => make_page(data).tabs.flatMap((tab) => tab.items);
const get_figures = (data) => get_items(data).filter((item) => item.kind === 'figure');
const find = (data, id) => {
  const item = get_items(data).find((one) => one.id === id);
  assert.ok(item, `there is no ${id}`);
  return item;
};
const get_value = (cell) => (cell !== null && typeof cell === 'object' ? cell.value : cell);

// Every choice of every figure, one at a time.
function* all_picks(figure) {
  const initial = get_initial_picks(figure);
  yield initial;
  for (const choice of figure.choices ?? []) {
    assert.ok(
      choice.options.some((option) => option.value === choice.initial),
      `${figure.id}: ${choice.id}`,
    );
    for (const option of choice.options.filter((one) => one.value !== choice.initial)) {
      yield { ...initial, [choice.id]: option.value };
    }
  }
}

function check_svg(svg, name) {
  assert.match(svg, /^<svg/, name);
  assert.doesNotMatch(svg, /NaN|undefined|Infinity/, name);
  // Quotes within an attribute, and characters that XML does not have, break a file of its own.
  assert.doesNotMatch(svg.replace(/[\w:-]+="[^"<]*"/g, ''), /="/, `${name} is not well-formed`);
  // eslint-disable-next-line no-control-regex
  assert.doesNotMatch(svg, /[\u0000-\u0008\u000b\u000c\u000e-\u001f]/, name);
}

function check_table(table, name) {
  assert.ok(table.columns.length > 0, name);
  for (const row of table.rows) {
    assert.equal(row.length, table.columns.length, name);
    row.map(get_value).forEach((value, i) => {
      assert.ok(value === null || typeof value === 'string' || Number.isFinite(value), `${name}: ${value}`);
      if (table.columns[i].numeric) {
        assert.notEqual(typeof value, 'string', `${name}, column ${table.columns[i].label}: ${value}`);
      }
    });
  }
}

const kPages = { run: make_run_data, identification: make_identification_data, reproduction: make_reproduction_data };

for (const [kind, make_data] of Object.entries(kPages)) {
  test(`${kind}: every figure draws in both looks and with all choices, and has its numbers`, () => {
    for (const figure of get_figures(make_data())) {
      for (const picked of all_picks(figure)) {
        const name = `${figure.id} ${JSON.stringify(picked)}`;
        check_svg(draw_svg(figure, kLight, picked, 640, 400), name);
        const table = figure.table(picked);
        check_table(table, name);
        assert.ok(table.rows.length > 0, name);
      }
      check_svg(draw_svg(figure, kDark, get_initial_picks(figure), 640, 400), figure.id);
      assert.match(figure.caption, /^[^a-z].*\.$/s, `${figure.id}: whole sentences`);
    }
  });

  test(`${kind}: identifiers are unique and all tables whole`, () => {
    const items = get_items(make_data());
    const ids = items.map((item) => item.id);
    assert.equal(new Set(ids).size, ids.length, ids.join(' '));
    items.filter((item) => item.kind === 'table').forEach((item) => check_table(item.table, item.id));
  });

  test(`${kind}: hostile names are drawn as text only`, () => {
    const hostile = `</script><img src=x onerror="alert(1)">'"&\u202e\u0000 ${'long '.repeat(800)}`;
    const rename = (value, key) => {
      if (Array.isArray(value)) {
        return value.map((one) => rename(one, ''));
      }
      if (value !== null && typeof value === 'object') {
        return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, rename(one, name)]));
      }
      return ['name', 'label', 'title', 'unit', 'remark', 'reason', 'test_set', 'engine', 'schedule', 'where', 'optimizer'].includes(key) &&
        typeof value === 'string' &&
        !(key === 'unit' && value === 'generation')
        ? hostile + value
        : value;
    };
    const data = rename(make_data(), '');
    for (const figure of get_figures(data)) {
      const svg = draw_svg(figure, kLight, get_initial_picks(figure), 640, 400);
      assert.doesNotMatch(svg, /<img|<\/script/i, figure.id);
      assert.ok(!svg.includes('long '.repeat(20)), `${figure.id}: names are cut`);
      check_svg(svg, figure.id);
      check_table(figure.table(get_initial_picks(figure)), figure.id);
    }
  });
}

test('a run has all its figures and tables under their names', () => {
  const ids = get_items(make_run_data()).map((item) => item.id);
  const wanted =
    'facts requirements-table results-table fitness variables front distance-response speed-sweep test-errors failures test-case signals-distance ' +
    'signals-speed signals-acceleration speed-reduction momentary-error joint-angles joint-errors joint-torques saturation design-table replay';
  wanted.split(' ').forEach((id) => assert.ok(ids.includes(id), id));
});

test('requirements have a sign and words beside their colour, and units that people read', () => {
  const { table } = find(make_run_data(), 'requirements-table');
  const states = table.rows.map((row) => [row[row.length - 1].mark, row[row.length - 1].value]);
  assert.deepEqual(states, [
    ['good', '✓ met'],
    ['near', '! met, within 10 % of the limit'],
    ['bad', '✗ missed; this limit binds'],
    ['none', '? not shown: a case has no number'],
  ]);
  assert.deepEqual(table.rows[0].slice(0, 6), ['overshoot', 'constraint', 5, 2, '%', 40]);
  assert.deepEqual(table.rows[1].slice(0, 5), ['tip error', 'report', 1, 0.95, 'mm']);
  assert.deepEqual(table.rows[3].slice(2, 6), [0.2, null, 's', null]);
  assert.ok(!get_items({ ...make_run_data(), requirements: [] }).some((item) => item.id === 'requirements-table'));
});

test('the repeated thesis has a counterpart of every figure', () => {
  const items = get_items(make_reproduction_data());
  const numbers = [
    ...['5.5', '5.6', '5.7', '5.8', '5.9', '5.10', '5.11', '5.12'],
    ...['6.4', '6.5', '6.6', '6.7', '6.8', '6.9', '6.10', '6.11', '6.12', '6.13', '6.15', '6.16'],
  ];
  numbers.forEach((number) => {
    const item = items.find((one) => one.id === `fig-${number}`);
    assert.equal(item?.thesis, `Fig. ${number}`);
  });
  assert.equal(items.find((item) => item.id === 'table-6.4').thesis, 'Table 6.4');
});

test('what is missing is left out', () => {
  const data = make_run_data();
  const check = (one) => {
    for (const figure of get_figures(one)) {
      check_svg(draw_svg(figure, kLight, get_initial_picks(figure), 640, 400), figure.id);
      check_table(figure.table(get_initial_picks(figure)), figure.id);
    }
    return get_items(one).map((item) => item.id);
  };
  assert.ok(!check({ ...data, test: null }).includes('test-errors'));
  assert.ok(!check({ ...data, front: null }).includes('front'));
  assert.ok(!check({ ...data, arm: { ...data.arm, sweep: null } }).includes('speed-sweep'));
  assert.ok(!check({ ...data, replays: [] }).includes('replay'));
  assert.ok(!check({ ...data, arm: { ...data.arm, health: null } }).includes('health'));
  const { training } = data;
  const empty = { index: [], cases: [], best: [], mean: [], worst: [], failed: [] };
  const no_incumbents = { ...training.incumbents, index: [], cases: [], training: [], test: [] };
  const ids = check({
    ...data,
    facts: [],
    arm: null,
    test: null,
    front: null,
    requirements: [],
    failure_reasons: [],
    importance: null,
    replays: [],
    variables: [],
    training: { ...training, ...empty, incumbents: no_incumbents },
  });
  assert.deepEqual(ids, ['tiles']);
  assert.ok(check({ ...data, training: { ...training, incumbents: no_incumbents } }).includes('fitness'));
  // A generation of which nothing had a number.
  const nothing = training.best.map(() => null);
  check({ ...data, training: { ...training, best: nothing, mean: nothing, worst: nothing } });
  const failed = { ...data.test, designs: [{ ...data.test.designs[0], errors: [null, null] }] };
  assert.ok(!check({ ...data, test: failed }).includes('test-errors'));
});

test('the variables that matter have a figure per region, the largest first', () => {
  const data = make_run_data();
  const ids = get_items(data).map((item) => item.id);
  assert.ok(ids.includes('importance-winner') && ids.includes('importance-run') && ids.includes('importance-notes'));
  const figure = get_figures(data).find((one) => one.id === 'importance-run');
  assert.ok(figure.caption.startsWith('A model explains only 31 %'));
  const { rows } = figure.table({});
  assert.equal(rows.length, 30);
  assert.ok(rows.every((row, i) => i === 0 || row[1] <= rows[i - 1][1]));
  check_svg(draw_svg(figure, kDark, {}, 640, figure.height), figure.id);
  for (const importance of [null, undefined]) {
    assert.ok(!get_items({ ...data, importance }).some((item) => item.id.startsWith('importance')));
  }
});

test('a repetition without parts leaves them out', () => {
  const data = make_reproduction_data();
  const bare = { ...data, facts: [], rows: [], runs: [], responses: [], replays: [], momentary: [], sweep: { ...data.sweep, series: [] } };
  const ids = get_items(bare).map((item) => item.id);
  assert.deepEqual(ids, ['fig-5.5', 'fig-5.6', 'fig-5.7', 'fig-5.8', 'fig-5.10']);
});

test('a run on a function has only what a function has', () => {
  const data = make_run_data();
  const variables = Array.from({ length: 20 }, (_, i) => ({
    ...data.variables[0],
    name: `x${i + 1}`,
    unit: '',
    lower: -5,
    upper: 5,
    start: 1,
    logarithmic: false,
  }));
  const groups = group_variables(variables);
  assert.deepEqual(
    groups.map((group) => group.members.length),
    [6, 6, 6, 2],
  );
  const page = {
    ...data,
    arm: null,
    replays: [],
    front: null,
    variables,
    quantity: { name: 'log10 of the gap', unit: '' },
    logarithmic: true,
  };
  for (const figure of get_figures(page)) {
    check_svg(draw_svg(figure, kLight, get_initial_picks(figure), 640, 400), figure.id);
  }
});

test('points name what made them, in the order of their distances', () => {
  const data = make_run_data();
  const figure = find(data, 'distance-response');
  const option = figure.draw(kLight, get_initial_picks(figure));
  const points = option.series.find((one) => one.type === 'line').data;
  points.slice(1).forEach((point, i) => assert.ok(point.value[0] > points[i].value[0], `${point.value[0]}`));
  const { distances_m } = data.arm.response;
  const point = points[points.length - 1];
  assert.equal(point.value[0], 100 * Math.max(...distances_m));
  assert.equal(point.command, 'armwright evaluate table-a5');
  assert.match(point.note, new RegExp(`^Move ${1 + distances_m.indexOf(Math.max(...distances_m))}, .* over 500 cases\\.`));
  const { ticks, log } = { ticks: option.xAxis.axisTick.customValues, log: option.xAxis.type === 'log' };
  assert.ok(log && ticks.length >= 3, `${ticks}`);
  assert.deepEqual(
    ticks,
    ticks.slice().sort((a, b) => a - b),
  );
});

test('errors start on a logarithmic axis, the first design over the others, and the reader may choose a linear one', () => {
  for (const id of ['distance-response', 'fitness']) {
    const figure = find(make_run_data(), id);
    const initial = get_initial_picks(figure);
    assert.equal(figure.draw(kLight, initial).yAxis.type, 'log');
    assert.equal(figure.draw(kLight, { ...initial, scale: 'linear' }).yAxis.type, 'value');
  }
  const figure = find(make_run_data(), 'distance-response');
  const lines = figure.draw(kLight, get_initial_picks(figure)).series.filter((one) => one.type === 'line');
  lines.slice(1).forEach((line) => assert.ok(line.z < lines[0].z));
});

test('published means stand beside ours', () => {
  const figure = find(make_reproduction_data(), 'fig-6.4');
  const svg = draw_svg(figure, kLight, get_initial_picks(figure), 640, 400);
  assert.match(svg, /Ramp: 5\.80 mm \(published 12\.6\)/);
});

test('panels of moves know their part of the time of the case', () => {
  const data = make_run_data();
  const figure = find(data, 'momentary-error');
  const { replay, case: get_case, panels } = figure.time;
  const initial = get_initial_picks(figure);
  assert.equal(replay, data.replays[0].id);
  assert.equal(get_case({ ...initial, case: 'train/1:1' }), 'train/1:1');
  assert.deepEqual(panels({ ...initial, classes: 'all' }), []);
  const [segment] = data.replays[0].cases[0].segments.slice(1);
  const [part] = panels({ ...initial, classes: '2' });
  const period_s = data.replays[0].task.control_period_s;
  assert.equal(part.from, segment.first_step * period_s);
  assert.equal(part.to, (segment.first_step + segment.steps) * period_s);
});

test('a zoomed curve has every row of its part of the time', () => {
  const set = make_replay_set('set'); // a control period of 10 ms
  const values = Float32Array.from({ length: 10000 }, (_, i) => (i % 7 === 0 ? NaN : Math.sin(i)));
  const rows = choose_rows(set, values, { from: 20, to: 21 });
  assert.deepEqual(
    rows,
    Array.from({ length: rows.length }, (_, i) => rows[0] + i),
  );
  assert.ok((rows[0] + 1) * 0.01 <= 20 && (rows[rows.length - 1] + 1) * 0.01 >= 21, `${rows[0]} to ${rows[rows.length - 1]}`);
  assert.ok(rows.length < 110);
  assert.ok(choose_rows(set, values).length <= 2000);
});

test('a histogram counts every number once, the largest too', () => {
  const values = [1, 2, 2.5, 10, 100, 1000, null];
  for (const log of [true, false]) {
    const histogram = make_histogram([values, [5]], log);
    const sum = (counts) => counts.reduce((a, b) => a + b, 0);
    assert.deepEqual(histogram.counts.map(sum), [6, 1]);
    assert.equal(histogram.edges.length, histogram.counts[0].length + 1);
  }
  assert.equal(make_histogram([[null]], true), null);
  assert.equal(
    make_histogram([[3, 3]], true).counts[0].reduce((a, b) => a + b, 0),
    2,
  );
});

test('stretches at a limit begin and end where the torque does', () => {
  const set = make_replay_set('set'); // a control period of 10 ms
  const effort = new Float32Array(1000);
  effort.fill(700, 100, 150);
  effort.fill(-900, 500, 501);
  const found = find_saturated(set, effort, [-900, 700]);
  assert.deepEqual(
    found.map((one) => one.map((time) => Math.round(time * 1000))),
    [
      [1000, 1500],
      [5000, 5010],
    ],
  );
  assert.deepEqual(find_saturated(set, effort, [-1000, 800]), []);
});

const get_tile = (data, label) => find(data, 'tiles').tiles.find((tile) => tile.label === label);
const get_line = (item, start) => item.lines.find((line) => line.name.startsWith(start));

test('the tiles have the result of the run and its effort', () => {
  const data = make_run_data();
  assert.deepEqual(
    find(data, 'tiles').tiles.map((tile) => `${tile.label}: ${tile.value}`),
    [
      ...['Mean error at rest: 50 → 6.10 mm', 'Error while moving: RMS 0.850 mm', 'Error after start-up: up to 112 mm'],
      ...['Failed test cases: ✓ 0 of 500', 'Total torque: 930000 N m', 'Simulations: 2800', 'Time taken: 2 min 5 s'],
    ],
  );
  assert.equal(get_tile(data, 'Time taken').detail, '4 min 0 s of processor time; in 2 parts; started 2026-01-31, 12:34 UTC');
  data.headline.times = { wall_s: 3, cpu_s: null, lives: 1 };
  assert.equal(get_tile(data, 'Time taken').detail, 'processor time unknown; started 2026-01-31, 12:34 UTC');
  data.headline.times = null;
  assert.equal(get_tile(data, 'Started').value, '2026-01-31');
  assert.equal(get_tile(data, 'Error while moving').detail, 'peak 5.30 mm; distance to the moving target');
  const error = get_tile(data, 'Mean error at rest');
  assert.equal(error.detail, 'better by a factor of 8.20: base controllers → winner, on 500 cases of test/2');
  data.headline.value = 0.1;
  assert.match(get_tile(data, 'Mean error at rest').detail, /^worse by a factor of 2: /);
  data.headline.value = 0.05001;
  assert.match(get_tile(data, 'Mean error at rest').detail, /^unchanged: /);
  data.headline.failures = 3;
  assert.deepEqual(
    { ...get_tile(data, 'Failed test cases'), detail: '' },
    { label: 'Failed test cases', value: '✗ 3 of 500', detail: '', mark: 'bad' },
  );
});

test('an arm that slides has a total force, and an old result no errors in motion', () => {
  const data = make_run_data();
  data.headline.total_force_n = 400;
  data.headline.motion.error_after_start_up_m = null; // a continuous path
  const list = () => find(data, 'tiles').tiles.map((tile) => `${tile.label}: ${tile.value}`);
  assert.deepEqual(list().slice(1, 5), [
    ...['Error while moving: RMS 0.850 mm', 'Failed test cases: ✓ 0 of 500', 'Total torque: 930000 N m', 'Total force: 400 N'],
  ]);
  data.headline.total_torque_n_m = null;
  data.headline.motion = null;
  assert.deepEqual(list().slice(1, 3), ['Failed test cases: ✓ 0 of 500', 'Total force: 400 N']);
});

test('tiles without a record are left out', () => {
  const data = make_run_data();
  data.arm = null;
  data.headline = {
    ...data.headline,
    started: '',
    value: 3.25e-7,
    quantity: { name: 'f', unit: '1' },
    failures: null,
    test_cases: null,
    total_torque_n_m: null,
    motion: null,
    times: null,
  };
  const list = () => find(data, 'tiles').tiles.map((tile) => `${tile.label}: ${tile.value}`);
  assert.deepEqual(list(), ['f: 3.25e-7', 'Evaluated cases: 2800']);
  assert.ok(!get_items(data).some((item) => item.id === 'health'));
  data.headline.value = null;
  assert.deepEqual(list(), ['Evaluated cases: 2800']);
});

test('the health card says in words what is not healthy', () => {
  const data = make_run_data();
  const card = find(data, 'health');
  assert.equal(
    card.verdict.text,
    '✗ The winner is not healthy: joint_2 is at an effort limit 12 % of the time. ' +
      'Watch: the effort of joint_3 oscillates by 7.0 % of its limit; 1 variable is near a bound.',
  );
  assert.equal(card.verdict.mark, 'bad');
  const saturation = get_line(card, 'Saturation');
  assert.equal(saturation.state, '✗ bad');
  assert.equal(saturation.value, 'joint_1 0 %, joint_2 12 %, joint_3 0.40 %, joint_4 0.60 %');
  assert.match(saturation.meaning, /Raise the limit/);
  const ripple = get_line(card, 'Oscillation above 10 Hz');
  assert.equal(ripple.state, '! watch');
  assert.match(ripple.value, /joint_3 7(\.0)? % at 25 Hz/);
  assert.equal(get_line(card, 'Variables').value, 'joint_1.d 0.40 % from its upper bound');
  assert.equal(get_line(card, 'Margin').value, 'joint_1 40 %, joint_2 0 %, joint_3 40 %, joint_4 40 %');
  assert.match(get_line(card, 'Overshoot').value, /median 1\.1 %, largest 31 %/);
  assert.match(get_line(card, 'Settling').value, /median 0\.12 s, longest 0\.50 s; 3 of 24 moves/);
  assert.match(card.caption, /test\/2:17, the median case/);
  data.arm.health.joints[0].saturation = 'bad';
  assert.match(find(data, 'health').verdict.text, /: joint_1 and joint_2 are at an effort limit up to 12 % of the time\./);
  assert.match(card.caption, /1 and 5 % of the time .* RMS of 5 and 20 % of the effort limit/);
});

test('the health card of a healthy winner, and of one that was not measured', () => {
  const data = make_run_data();
  const { health } = data.arm;
  health.joints.forEach((joint) => Object.assign(joint, { saturation: 'good', ripple: 'good' }));
  health.bounds = { grade: 'good', near: 0, nearest: [{ name: 'joint_4.p', bound: 'lower', distance: 0.21 }] };
  let card = find(data, 'health');
  assert.deepEqual(card.verdict, { text: '✓ The winner is healthy.', mark: 'good' });
  assert.ok(card.lines.every((line) => line.meaning === ''));
  assert.equal(get_line(card, 'Variables').value, 'none; the nearest is joint_4.p 21 % from its lower bound');
  health.bounds.grade = 'watch';
  health.bounds.near = 2;
  assert.deepEqual(find(data, 'health').verdict, {
    text: '! Nothing about the winner is bad, but watch: 2 variables are near a bound.',
    mark: 'near',
  });
  health.bounds.grade = 'good';
  health.joints.forEach((joint) => Object.assign(joint, { ripple: null, ripple_share: null, ripple_rms: null, ripple_hz: null }));
  health.moves = null;
  card = find(data, 'health');
  assert.match(card.verdict.text, /^\? Nothing about the winner is bad as far as it was checked\. Not checked: Oscillation/);
  assert.equal(card.verdict.mark, 'none');
  assert.equal(get_line(card, 'Overshoot').value, 'no move that counts');
  health.failing = 'bad';
  health.failures = 2;
  assert.match(find(data, 'health').verdict.text, /^✗ The winner is not healthy: 2 of 500 test cases failed\. Not checked/);
});

test('a winner that violates a constraint on the test set is not healthy', () => {
  const data = make_run_data();
  const { health } = data.arm;
  assert.ok(!find(data, 'health').lines.some((line) => line.name.startsWith('Constraints')));
  health.constraints = { grade: 'good', violated: [] };
  assert.ok(find(data, 'health').lines.some((line) => line.name === 'Constraints on the test set' && line.value === 'met'));
  health.constraints = { grade: 'bad', violated: ['total_torque'] };
  assert.match(find(data, 'health').verdict.text, /^✗ The winner is not healthy: it violates total_torque/);
  health.constraints = { grade: null, violated: [] };
  assert.match(find(data, 'health').verdict.text, /Not checked: Constraints on the test set/);
});

test('a winner is healthy only if it works under all other conditions', () => {
  const data = make_run_data();
  const { health } = data.arm;
  health.joints.forEach((joint) => Object.assign(joint, { saturation: 'good', ripple: 'good' }));
  health.bounds = { grade: 'good', near: 0, nearest: [{ name: 'joint_4.p', bound: 'lower', distance: 0.21 }] };
  let card = find(data, 'health');
  assert.deepEqual(card.verdict, { text: '✓ The winner is healthy.', mark: 'good' });
  assert.equal(get_line(card, 'Under other').value, 'works with engine ode and masses +10 %');
  assert.match(card.caption, /first 10 cases: a mean error up to 0\.3(00)? mm works/);

  const [ode, masses] = health.check.settings;
  Object.assign(masses, { grade: 'watch', outcome: '3.2 times its own error' });
  assert.deepEqual(find(data, 'health').verdict, {
    text: '! Nothing about the winner is bad, but watch: 3.2 times its own error with masses +10 %.',
    mark: 'near',
  });
  health.check.settings.push({
    name: '2 physics steps per control period',
    grade: 'bad',
    outcome: 'fails in 10 of 10 cases',
    mean_m: null,
    reason: '',
  });
  card = find(data, 'health');
  assert.equal(card.verdict.mark, 'bad');
  assert.match(card.verdict.text, /^✗ The winner is not healthy: .*fails in 10 of 10 cases with 2 physics steps per control period\./);
  assert.equal(get_line(card, 'Under other').state, '✗ bad');

  // A setting that was not simulated.
  health.check.settings = [ode, { ...masses, grade: null, outcome: 'not simulated', reason: 'no armature' }];
  card = find(data, 'health');
  assert.equal(card.verdict.mark, 'none');
  assert.equal(get_line(card, 'Under other').state, '? not checked');
  assert.equal(get_line(card, 'Under other').meaning, 'no armature');

  health.check = null;
  card = find(data, 'health');
  assert.deepEqual(card.verdict, {
    text: '? Nothing about the winner is bad as far as it was checked. Not checked: Under other conditions.',
    mark: 'none',
  });
  assert.equal(get_line(card, 'Under other').state, '? not checked');
});

// ---------------------------------------------------------------- a run in progress

test('the words beside the progress bar say what is known', () => {
  assert.deepEqual(describe_progress(make_run_data()), []);
  const data = { ...make_run_data(), finished: false, progress: { done: 1999, total: 4000, unit: 'cases' } };
  assert.deepEqual(describe_progress(data), ['1999 of 4000 cases (49 %)']);
  data.watched = { simulations: 1999, per_second: null, left_s: null, running: [], failed_evaluations: 0, failures: [] };
  assert.deepEqual(describe_progress(data), [
    '1999 of 4000 cases (49 %)',
    'time left: unknown yet',
    'simulations per second: unknown yet',
    'no candidate has failed',
  ]);
  data.watched = { ...data.watched, per_second: 12.345, left_s: 162, failed_evaluations: 1 };
  assert.deepEqual(describe_progress(data).slice(1), [
    'about 2 min 42 s left',
    '12.3 simulations per second in the last minute',
    '1 candidate has failed',
  ]);
});

test('a watched page of a run has the failures after the headline, or says that there is none', () => {
  const data = { ...make_run_data(), finished: false, progress: { done: 0, total: 4, unit: 'cases' } };
  const ids = () => make_page(data).tabs[0].items.map((item) => item.id);
  const usual = ids();
  data.watched = { simulations: 9, per_second: 1, left_s: 1, running: [], failed_evaluations: 0, failures: [] };
  assert.deepEqual(ids(), [usual[0], 'failures-so-far', ...usual.slice(1)]);
  assert.deepEqual(find(data, 'failures-so-far').paragraphs, ['Nothing has failed.']);
  data.watched.failures = [{ where: 'evaluation 3', state: 'diverged', reason: 'joint_2 moves at 1e9 rad/s' }];
  assert.deepEqual(ids(), [usual[0], 'failures-so-far', ...usual.slice(1)]);
  assert.deepEqual(find(data, 'failures-so-far').table.rows, [['evaluation 3', 'diverged', 'joint_2 moves at 1e9 rad/s']]);
  data.finished = true;
  assert.deepEqual(ids(), usual);
});

test('a CSV text is signals only if all cells are numbers and the abscissa grows', () => {
  const signals = read_signals('time [s],"speed, left [rad/s]",count\n0,1,2\n1,3,4\n');
  assert.deepEqual(signals, [
    { name: 'time', unit: 's', values: [0, 1] },
    { name: 'speed, left', unit: 'rad/s', values: [1, 3] },
    { name: 'count', unit: '', values: [2, 4] },
  ]);
  for (const text of ['', 't,x\n0,1\n', 't,x\n1,1\n0,1\n', 't,x\n0,a\n1,2\n', 't,x\n0,1\n1\n', 't,x\n0,\n1,2\n']) {
    assert.equal(read_signals(text), null, JSON.stringify(text));
  }
});

test('a record that cannot be shown says so, and one without signals is left out', () => {
  const data = make_run_data();
  const has_note = (record) => {
    data.record = record;
    return get_items(data).some((item) => item.id === 'winner-record-note');
  };
  assert.ok(has_note('t [s],x\n1,1\n0,1\n'));
  assert.ok(has_note('t [s],x\n0,a\n1,2\n'));
  assert.ok(!has_note('t [s],x\n0,1\n1,2\n'));
  assert.ok(!has_note('\n'));
  assert.ok(!has_note('t [s]\n0\n'));
  assert.ok(!has_note(null));
});

test('the legend of the training names a test set only if incumbents were tested', () => {
  const data = make_run_data();
  const has_test = () => {
    const figure = find(data, 'fitness');
    return draw_svg(figure, kLight, get_initial_picks(figure), 640, 400).includes('incumbent on the test set');
  };
  assert.ok(has_test());
  data.training.incumbents.test = data.training.incumbents.test.map(() => null);
  assert.ok(!has_test());
});

test('an objective in metres without an arm keeps its unit, and a category shows its words', () => {
  const data = make_run_data();
  data.arm = null;
  data.replays = [];
  data.requirements = [];
  data.headline = { ...data.headline, value: 2, quantity: { name: 'sag', unit: 'm', own_unit: true }, test_cases: null };
  data.variables = [{ ...data.variables[0], type: 'category', choices: ['plain', 'dear'], lower: 0, upper: 1, start: 0, winner: 1 }];
  data.limits = [{ quantity: { name: 'width', unit: 'm', own_unit: true }, limit: 3, value: 4, is_met: false }];
  assert.ok(find(data, 'tiles').tiles.some((tile) => tile.value === '2 m'));
  assert.deepEqual(find(data, 'variables-table').table.rows[0].slice(4, 7), ['plain, dear', 'plain', 'dear']);
  assert.deepEqual(find(data, 'limits-table').table.rows[0].map(get_value), ['width', 3, 4, 'm', '✗ missed']);
});
