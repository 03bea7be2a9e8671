// The page that compares two runs or two studies, on made-up data.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const { draw_svg, get_initial_picks, kDark, kLight, make_page, make_replay_set, make_run_data, make_study_data } = await load(`
  export { draw_svg, get_initial_picks } from './src/charts/svg';
  export { kDark, kLight } from './src/charts/look';
  export { make_page } from './src/figures/page';
  export { make_replay_set, make_run_data } from './tests/fixtures/pages';
  export { make_study_data } from './tests/fixtures/study_data';
`);

const kSettings = [
  { name: 'problem.physics.engine', a: 'ode', b: 'ode', basis: 'the engine' },
  { name: 'problem.sets.test', a: 'test/2', b: 'test/2', basis: 'the test set' },
  { name: 'problem.workspace.radius_m', a: '0.8', b: '0.8', basis: 'the problem' },
  { name: 'run.budget', a: '1400', b: '1400', basis: 'the budget' },
  { name: 'run.optimizer', a: 'ga', b: 'cmaes', basis: null },
];

function make_comparison(parts) {
  const { facts, program, robots } = make_run_data();
  return {
    ...{ format: 2, kind: 'comparison', title: 'A: x – B: y', subtitle: '', program, folder: 'x and y', command: 'armwright report x y' },
    ...{
      finished: true,
      progress: null,
      watched: null,
      notes: [],
      facts,
      robots,
      replays: [],
      settings: kSettings,
      runs: null,
      studies: null,
    },
    ...parts,
  };
}

function make_runs() {
  const [a, b] = [make_run_data(), make_run_data()];
  b.headline.value = a.headline.value / 2;
  const paired = { cases: 500, wins: 40, ties: 10, losses: 450, p: 1e-9, a12: 0.1, better: 'b' };
  return { a, b, same_cases: true, paired };
}

const get_items = (data) => make_page(data).tabs.flatMap((tab) => tab.items);
const find = (data, id) => {
  const item = get_items(data).find((one) => one.id === id);
  assert.ok(item, `there is no ${id}`);
  return item;
};

function check_figures(data) {
  const items = get_items(data);
  assert.equal(new Set(items.map((one) => one.id)).size, items.length, 'two items have one name');
  for (const figure of items.filter((one) => one.kind === 'figure')) {
    for (const look of [kLight, kDark]) {
      const svg = draw_svg(figure, look, get_initial_picks(figure), 640, 400);
      assert.match(svg, /^<svg/);
      assert.doesNotMatch(svg, /NaN|undefined|Infinity/, figure.id);
    }
    assert.ok(figure.table(get_initial_picks(figure)).rows.length > 0, figure.id);
  }
}

// ---------------------------------------------------------------- runs

test('a comparison of runs has the figures of both and one replay', () => {
  const data = make_comparison({ runs: make_runs(), replays: [make_replay_set('run')] });
  check_figures(data);
  assert.deepEqual(
    make_page(data).tabs.map((tab) => tab.id),
    ['overview', 'training', 'response', 'motion', 'design', 'settings'],
  );
  for (const id of ['tiles-a', 'tiles-b', 'health-a', 'health-b', 'courses', 'test-errors', 'case-pairs', 'momentary-error']) {
    find(data, id);
  }
});

test('the headline names the better run, by how much, and what the cases decide', () => {
  const runs = make_runs();
  const data = make_comparison({ runs });
  const read = () => find(data, 'headline').paragraphs;
  assert.match(read()[0], /^B has the smaller mean error at rest on the test set: [\d.]+ mm against [\d.]+ mm \(−50 %\)\.$/);
  assert.match(
    read()[1],
    /^Case by case, A is better in 40 of 500 and B in 450; by the ranks of the differences, B is better \(signed-rank test, p <1e-6\)\. /,
  );
  assert.match(read()[1], /The runs are comparable: problem, test set, engine and budget are the same\.$/);
  Object.assign(runs.paired, { wins: 450, losses: 40 }); // many small wins lose against few large ones
  assert.match(read()[1], /A is better in 450 of 500 and B in 40; by the ranks of the differences, B is better/);
  Object.assign(runs.paired, { p: 0.2, better: null });
  assert.match(read()[1], /the cases do not tell the winners apart \(signed-rank test, p = 0\.2/);
  runs.paired.cases = 5;
  assert.match(read()[1], /not enough cases to decide; at least 6 are needed\. /);
  [runs.a, runs.b] = [runs.b, runs.a];
  assert.match(read()[0], /^A has the smaller mean error at rest/);
  runs.b.headline.value = runs.a.headline.value;
  assert.match(read()[0], /^A and B have the same mean error at rest/);
  runs.b.headline.value = null;
  assert.match(read()[0], /^B has no result on the test set, so/);
  runs.b.finished = false;
  assert.match(read()[0], /^B has no result on the test set yet, so/);
  runs.b.headline = { ...runs.a.headline, quantity: { name: 'f', unit: '' } };
  assert.deepEqual(read(), ['The results of the runs cannot be compared: they minimise different quantities.']);
});

test('the headline says what differs in the basis of the comparison', () => {
  const with_setting = (name, b) =>
    find(
      make_comparison({
        runs: make_runs(),
        settings: kSettings.map((one) => (one.name === name ? { ...one, b } : one)),
      }),
      'headline',
    ).paragraphs.pop();
  assert.equal(with_setting('problem.workspace.radius_m', '0.7'), 'The results of the runs cannot be compared: the problem differs.');
  const differing = [{ name: 'run.problem', a: 'sphere', b: 'constrained', basis: 'the problem' }];
  assert.ok(get_items(make_comparison({ runs: make_runs(), settings: differing })).every((item) => item.id !== 'courses'));
  assert.match(with_setting('run.budget', '700'), /Both winners were tested on the same cases, but the budget differs\.$/);
  assert.match(with_setting('problem.physics.engine', 'articulated'), /Compare with care: the engine differs\.$/);
  assert.match(with_setting('problem.sets.test', 'test/3'), /Compare with care: the test set differs\.$/);
});

test('settings that differ come first, the others have their own tab', () => {
  const data = make_comparison({ runs: make_runs() });
  assert.deepEqual(find(data, 'differences').table.rows, [['run.optimizer', 'ga', 'cmaes']]);
  assert.equal(find(data, 'equal-settings').table.rows.length, 4);
  data.settings = [{ name: 'run.seed', a: '1', b: null, basis: null }];
  assert.deepEqual(find(data, 'differences').table.rows, [['run.seed', '1', '–']]);
});

test('designs are compared by shares of the range', () => {
  const runs = make_runs();
  const base = { ...runs.a.variables[0], lower: 0, upper: 10, winner: 2, logarithmic: false };
  runs.a.variables = [base, { ...base, name: 'log', lower: 1, upper: 100, winner: 1, logarithmic: true }, { ...base, name: 'mine' }];
  runs.b.variables = [
    { ...base, winner: 5 },
    { ...base, name: 'log', winner: 10 },
    { ...base, name: 'yours' },
  ];
  const rows = find(make_comparison({ runs }), 'variables-compared').table.rows;
  assert.deepEqual(
    rows.map((row) => [row[0], ...row.slice(2)]),
    [
      [base.name, 2, 5, 30],
      ['log', 1, 10, 50],
      ['mine', 2, null, null],
      ['yours', null, 2, null],
    ],
  );
});

test('runs without common cases, tests or arms have a page', () => {
  const runs = make_runs();
  Object.assign(runs, { same_cases: false, paired: null });
  Object.assign(runs.b, { arm: null, test: null });
  const data = make_comparison({ runs });
  check_figures(data);
  assert.ok(get_items(data).every((item) => item.id !== 'case-pairs' && item.id !== 'test-errors'));
});

// ---------------------------------------------------------------- studies

function make_cell(problem, optimizer, more = {}) {
  return {
    ...{
      problem,
      optimizer,
      quantity: { name: 'error', unit: 'm' },
      pairs: 8,
      wins: 0,
      ties: 0,
      losses: 8,
      a12: 0,
      p: 0.0078,
      p_holm: 0.0156,
      untested: null,
    },
    ...{ a: { runs: 8, q1: 0.004, median: 0.005, q3: 0.006 }, b: { runs: 8, q1: 0.001, median: 0.002, q3: 0.003 }, better: 'b', ...more },
  };
}

test('a comparison of studies has the curves of both', () => {
  const [a, b] = [1, 2].map(() => make_study_data({ optimizers: 3, replicates: 8, problems: 2 }));
  const problem = a.problems[0].label;
  const data = make_comparison({ studies: { a, b, cells: [make_cell(problem, a.optimizers[0].label)] } });
  check_figures(data);
  const names = find(data, 'convergence')
    .table({})
    .rows.map((row) => row[0]);
  assert.deepEqual([...new Set(names.map((name) => name.slice(0, 3)))].sort(), ['A: ', 'B: ']);
  a.problems.forEach((one) => (one.has_front = true));
  assert.ok(get_items(data).every((item) => item.id !== 'convergence')); // hypervolumes have no common reference
  a.problems.forEach((one) => (one.has_front = false));
  find(data, 'convergence');
  b.problems.forEach((one) => (one.checkpoints = one.checkpoints.map((cases) => 2 * cases)));
  assert.ok(get_items(data).every((item) => item.id !== 'convergence')); // curves at other budgets do not fit
});

test('the headline of studies repeats the tests', () => {
  const [a, b] = [1, 2].map(() => make_study_data({ optimizers: 2, replicates: 8, problems: 2 }));
  const read = (cells) => find(make_comparison({ studies: { a, b, cells } }), 'headline').paragraphs[0];
  const open = { better: null, p_holm: 1 };
  assert.equal(read([make_cell('q1', 'ga'), make_cell('q2', 'ga')]), 'B is better for ga on q1 and q2.');
  assert.equal(
    read([make_cell('q1', 'ga', { better: 'a' }), make_cell('q2', 'ga'), make_cell('q1', 'cmaes', open)]),
    'A is better for ga on q1; B is better for ga on q2; the other result cannot be told apart.',
  );
  assert.match(read([make_cell('q1', 'ga', open)]), /^No result of A can be told apart from that of B, for the one optimizer/);
  const untested = (why) => ({ pairs: 0, p: null, p_holm: null, better: null, untested: why });
  assert.equal(
    read([make_cell('q1', 'ga', untested('the seed differs')), make_cell('q1', 'cmaes', untested('the seed differs'))]),
    'No test can tell the studies apart: the seed differs.',
  );
  assert.equal(
    read([make_cell('q1', 'ga', open), make_cell('q2', 'ga', untested('the engine differs'))]),
    'No result of A can be told apart from that of B, for the one optimizer and problem that has a test. 1 result without a test: the engine differs.',
  );
  assert.equal(
    read([make_cell('q1', 'ga'), make_cell('q2', 'ga', untested('the engine differs'))]),
    'B is better for ga on q1. 1 result without a test: the engine differs.',
  );
  assert.match(read([]), /no problem that both have has values with the same meaning/);
  b.problems = [];
  assert.match(read([]), /no optimizer and problem in common/);
  const settings = [{ name: 'value', a: 'objective', b: 'failures', basis: 'the value of a run' }];
  assert.match(
    find(make_comparison({ studies: { a, b, cells: [] }, settings }), 'headline').paragraphs[0],
    /the values of their runs have different meanings: objective in A, failures in B\.$/,
  );
});

test('the grid says whether spreads overlap and what the test decides', () => {
  const [a, b] = [1, 2].map(() => make_study_data({ optimizers: 2, replicates: 8, problems: 1 }));
  const cells = [
    make_cell('q1', 'ga'),
    make_cell('q1', 'cmaes', { b: { runs: 8, q1: 0.0045, median: 0.0051, q3: 0.0052 }, better: null, p_holm: 1 }),
  ];
  const { rows } = find(make_comparison({ studies: { a, b, cells } }), 'compared-cells').table;
  assert.deepEqual(rows[0].slice(2), [
    { value: '▶ B is better', mark: 'good' },
    '5 mm (4 to 6)',
    '2 mm (1 to 3)',
    '−60 %',
    'no',
    0,
    '0.016',
    8,
  ]);
  assert.equal(rows[1][2].value, '= not told apart');
  assert.equal(rows[1][6], 'yes');
  const few = make_cell('q1', 'ga', {
    pairs: 5,
    p: null,
    p_holm: null,
    better: null,
    untested: 'not enough pairs to decide; at least 6 are needed',
  });
  const [row] = find(make_comparison({ studies: { a, b, cells: [few] } }), 'compared-cells').table.rows;
  assert.equal(row[2].value, '? no test: not enough pairs to decide; at least 6 are needed');
});
