// The figures of a comparison, drawn as `armwright plot` does.
import assert from 'node:assert/strict';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { build } from 'esbuild';

const folder = await mkdtemp(join(tmpdir(), 'armwright-study-'));
after(() => rm(folder, { recursive: true }));
const bundle = join(folder, 'study.mjs');
await build({
  entryPoints: [join(dirname(fileURLToPath(import.meta.url)), 'fixtures/study_bundle.ts')],
  bundle: true,
  format: 'esm',
  platform: 'neutral',
  mainFields: ['module', 'main'],
  define: { 'process.env.NODE_ENV': '"production"' },
  outfile: bundle,
});
const study = await import(pathToFileURL(bundle).href);

const get_items = (tabs) => tabs.flatMap((tab) => tab.items);
const get_figures = (tabs) => get_items(tabs).filter((item) => item.kind === 'figure');
const find = (tabs, id) => get_items(tabs).find((item) => item.id === id);

// Every option of every choice, the others as they are at first.
function list_picks(figure) {
  const initial = study.get_initial_picks(figure);
  return [initial].concat(
    (figure.choices ?? []).flatMap((choice) => choice.options.slice(0, 4).map((option) => ({ ...initial, [choice.id]: option.value }))),
  );
}

function check_table(table, where) {
  for (const row of table.rows) {
    assert.equal(row.length, table.columns.length, where);
    for (const cell of row) {
      const value = cell !== null && typeof cell === 'object' ? cell.value : cell;
      assert.ok(value === null || typeof value === 'string' || Number.isFinite(value), `${where}: ${value}`);
    }
  }
}

// Draws every figure with every choice, and as it is at first also in the dark look.
function check_tabs(tabs) {
  const tab_ids = tabs.map((tab) => tab.id);
  assert.equal(new Set(tab_ids).size, tab_ids.length);
  const ids = get_items(tabs).map((item) => item.id);
  assert.equal(new Set(ids).size, ids.length, ids.join(' '));
  for (const item of get_items(tabs)) {
    assert.match(item.id, /^[a-z0-9][a-z0-9.-]*$/);
    if (item.kind === 'table') {
      check_table(item.table, item.id);
    }
    if (item.kind !== 'figure') {
      continue;
    }
    assert.match(item.caption, /\.$/);
    const draw = (look, picked) => {
      const svg = study.draw_svg(item, look, picked, 640, 400);
      assert.ok(svg.startsWith('<svg') && svg.endsWith('</svg>'), item.id);
      assert.doesNotMatch(svg, /NaN|undefined|Infinity/, item.id);
    };
    for (const picked of list_picks(item)) {
      check_table(item.table(picked), item.id);
      draw(study.kLight, picked);
    }
    draw(study.kDark, study.get_initial_picks(item));
  }
}

test('a single problem has all figures, and every one draws', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 12, replicates: 15, problems: 1 }));
  assert.deepEqual(
    tabs.map((tab) => tab.id),
    ['verdict', 'problem-q1-problem-1', 'profiles', 'designs'],
  );
  assert.deepEqual(
    get_figures(tabs).map((figure) => figure.id),
    [
      'standing',
      'ranks',
      'convergence',
      'values',
      'runtime-ecdf',
      'cost-quality',
      'pairs',
      'data-profile',
      'performance-profile',
      'parallel',
    ],
  );
  for (const id of ['ranking', 'running-times', 'pairs-table', 'cells']) {
    assert.equal(find(tabs, id).kind, 'table');
  }
  check_tabs(tabs);
});

test('the parallel axes say of each type of variable how its axis is divided', () => {
  const data = study.make_study_data({ optimizers: 2, replicates: 2, problems: 1 });
  const caption = () => find(study.make_study_tabs(data), 'parallel').caption;
  assert.match(caption(), /Axes are logarithmic in the magnitude unless/);
  assert.doesNotMatch(caption(), /integers|category/);
  const [first, second] = data.problems[0].variables;
  Object.assign(first, { type: 'integer' });
  assert.match(caption(), /Axes of real variables are logarithmic.*Axes of integers are linear unless/);
  Object.assign(second, { type: 'category', choices: ['thin', 'thick'], lower: 0, upper: 1 });
  assert.match(caption(), /one place per word/);
});

test('several problems have a tab each, many a choice', () => {
  const few = study.make_study_tabs(study.make_study_data({ optimizers: 3, replicates: 4, problems: 2 }));
  assert.ok(find(few, 'convergence-q1-problem-1') && find(few, 'convergence-q1-problem-2') && find(few, 'ranks'));
  check_tabs(few);
  const many = study.make_study_tabs(study.make_study_data({ optimizers: 3, replicates: 4, problems: 8 }));
  assert.deepEqual(
    many.map((tab) => tab.id),
    ['verdict', 'problems', 'profiles', 'designs'],
  );
  const choice = find(many, 'convergence').choices[0];
  assert.equal(choice.options.length, 8);
  assert.equal(find(many, 'ranking').table.columns[0].label, 'problem');
  assert.equal(find(many, 'ranking').table.rows.length, 24);
  check_tabs(many);
});

test('the best design on another engine names the run that made it', () => {
  const { table } = find(study.make_study_tabs(study.make_study_data({ optimizers: 4, replicates: 3, problems: 1 })), 'ranking');
  const column = table.columns.findIndex((one) => one.label === 'best design there');
  const cells = table.rows.map((row) => row[column]).filter((cell) => cell !== null);
  assert.ok(cells.length > 0);
  for (const cell of cells) {
    assert.match(cell.command, /^armwright rerun study \d+\/\d+\/r1$/);
    assert.match(cell.note, /replicate 1\.$/);
  }
});

test('forty optimizers with fifteen replicates draw, the best twelve at first', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 40, replicates: 15, problems: 1 }));
  check_tabs(tabs);
  const best = find(tabs, 'ranking')
    .table.rows.slice(0, 12)
    .map((row) => row[0]);
  for (const id of ['convergence', 'runtime-ecdf', 'parallel']) {
    const { legend } = find(tabs, id).draw(study.kLight, {});
    assert.equal(legend.data.length, 40, id);
    const drawn = Object.keys(legend.selected).filter((name) => legend.selected[name]);
    assert.deepEqual(drawn.sort(), best.slice().sort(), id);
  }
  assert.match(
    find(tabs, 'convergence').caption,
    /Of the 40 optimizers, the best 12 are drawn at first\. The legend switches them on and off\.$/,
  );
});

test('up to twelve optimizers are all drawn at first', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 12, replicates: 6, problems: 1 }));
  for (const id of ['convergence', 'runtime-ecdf', 'data-profile', 'performance-profile', 'parallel']) {
    const { legend } = find(tabs, id).draw(study.kLight, {});
    assert.ok(
      Object.values(legend.selected).every((one) => one),
      id,
    );
    assert.doesNotMatch(find(tabs, id).caption, /at first/);
  }
});

test('up to four optimizers have bands of quartiles', () => {
  const data = study.make_study_data({ optimizers: 12, replicates: 6, problems: 1, infinite: 'none' });
  const draw = (shown) => find(study.make_study_tabs(data, shown), 'convergence');
  const count_bands = (figure) =>
    figure.draw(study.kLight, {}).series.filter((one) => one.type === 'custom' && one.name !== undefined).length;
  assert.equal(count_bands(draw(undefined)), 0);
  assert.match(draw(undefined).caption, /for at most 4 optimizers; the table has the quartiles of all/);
  assert.equal(count_bands(draw([0, 1, 2, 3])), 4);
  assert.match(draw([0, 1, 2, 3]).caption, /The band shows the quartiles/);
  assert.equal(count_bands(draw([0, 1, 2, 3, 4])), 0);
});

test('sixteen optimizers differ in colour, dash or symbol', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 16, replicates: 6, problems: 1, infinite: 'none' }));
  for (const look of [study.kLight, study.kDark]) {
    for (const id of ['convergence', 'runtime-ecdf', 'data-profile', 'performance-profile', 'parallel']) {
      const lines = find(tabs, id)
        .draw(look, {})
        .series.filter((one) => one.type === 'line' && one.name !== undefined);
      assert.equal(lines.length, 16, id);
      const describe = (line) => JSON.stringify([line.lineStyle.color, line.lineStyle.type, line.symbol, line.itemStyle.borderColor ?? '']);
      assert.equal(new Set(lines.map(describe)).size, 16, id);
      // The symbols alone distinguish the optimizers of a colour.
      assert.equal(
        new Set(lines.map((line) => JSON.stringify([line.lineStyle.color, line.symbol, line.itemStyle.borderColor ?? '']))).size,
        16,
        id,
      );
    }
    const points = find(tabs, 'cost-quality')
      .draw(look, study.get_initial_picks(find(tabs, 'cost-quality')))
      .series.find((one) => one.type === 'scatter').data;
    assert.equal(points.length, 16);
    assert.equal(new Set(points.map((point) => JSON.stringify([point.symbol, point.itemStyle]))).size, 16);
  }
});

test('the pairs of all problems are pooled, and each problem can be chosen', () => {
  const make_problem = (targets, checkpoints, ecdfs) => ({
    targets: Array.from({ length: targets }, (_, i) => i),
    checkpoints,
    results: ecdfs.map((ecdf) => ({ ecdf })),
  });
  const pooled = study.pool_ecdfs([
    make_problem(10, [10, 100, 1000], [[0, 0.5, 1], [0, 0, 0.1]]), // prettier-ignore
    make_problem(30, [20, 100], [[0.2, 0.4], [0, 0]]), // prettier-ignore
  ]);
  assert.deepEqual(pooled.checkpoints, [10, 20, 100, 1000]);
  // 10 pairs per run on the first problem and 30 on the second one.
  const expected = [
    [0, 6 / 40, 17 / 40, 22 / 40],
    [0, 0, 0, 1 / 40],
  ];
  pooled.shares.forEach((shares, o) => shares.forEach((share, i) => assert.ok(Math.abs(share - expected[o][i]) < 1e-15, `${o} ${i}`)));

  const data = study.make_study_data({ optimizers: 3, replicates: 4, problems: 3 });
  const figure = find(study.make_study_tabs(data), 'pooled-ecdf');
  assert.deepEqual(
    figure.choices[0].options.map((option) => option.label),
    ['all 3 problems', 'Q1 problem 1', 'Q1 problem 2', 'Q1 problem 3'],
  );
  assert.match(figure.caption, /pairs of 3 problems that are reached/);
  const single = figure.table({ problem: '1' }).rows.filter((row) => row[0] === data.optimizers[0].label);
  assert.deepEqual(
    single.map((row) => row[2]),
    data.problems[1].results[0].ecdf,
  );
  data.problems[0].missing = 1;
  assert.match(find(study.make_study_tabs(data), 'pooled-ecdf').caption, /of 2 problems .*Problems with missing runs are left out/);
  data.problems[1].missing = 1;
  assert.equal(find(study.make_study_tabs(data), 'pooled-ecdf'), undefined);
});

test('a profile opens where something is seen', () => {
  const data = study.make_study_data({ optimizers: 3, replicates: 4, problems: 2 });
  const empty = data.optimizers.map(() => data.overall.kappas.map(() => 0));
  // At the tolerance 1e-3 the first optimizer solves 15 % at the last three budgets, at 0.1 half.
  const some = empty.map((shares, o) => shares.map((_, i) => (o === 0 && i > 37 ? 0.15 : 0)));
  const half = empty.map((shares, o) => shares.map((_, i) => (o === 0 && i > 20 ? 0.5 : 0)));
  data.overall.data_profiles = [half, some, empty].map((shares, i) => ({ tolerance: [0.1, 0.001, 0.00001][i], shares }));
  const figure = find(study.make_study_tabs(data), 'data-profile');
  assert.equal(figure.choices[0].initial, '0');
  const get_axes = (tolerance) => {
    const { xAxis, yAxis, series } = figure.draw(study.kLight, { tolerance });
    const line = series.find((one) => one.name === data.optimizers[0].label);
    return { left: xAxis.min, top: yAxis.max, points: line.data.length, first: line.data[0].value };
  };
  const [wide, narrow, none] = ['0', '1', '2'].map(get_axes);
  assert.deepEqual([wide.top, narrow.top, none.top], [0.5, 0.2, 1]);
  assert.deepEqual(narrow.first, [data.overall.kappas[37], 0]);
  assert.equal(narrow.points, 4);
  assert.ok(narrow.left <= data.overall.kappas[37] && narrow.left > data.overall.kappas[35]);
  assert.deepEqual(wide.first, [data.overall.kappas[20], 0]);
  assert.equal(none.points, 41);
  assert.equal(figure.table({ tolerance: '1' }).rows.length, 3 * 41); // the table has all budgets
});

test('fronts draw with their reference point, in millimetres', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 5, replicates: 6, problems: 1, fronts: true }));
  check_tabs(tabs);
  const front = find(tabs, 'front');
  assert.match(study.draw_svg(front, study.kLight, {}, 640, 400), />error \(mm\)</);
  const option = front.draw(study.kLight, {});
  assert.deepEqual(option.series.find((one) => one.name === 'reference point').data[0].value, [12, 700]);
});

test('one optimizer, one replicate, no values at all', () => {
  for (const optimizers of [1, 2]) {
    for (const infinite of ['none', 'all']) {
      check_tabs(study.make_study_tabs(study.make_study_data({ optimizers, replicates: 1, problems: 1, infinite, fronts: true })));
    }
  }
  check_tabs(study.make_study_tabs(study.make_study_data({ optimizers: 12, replicates: 6, problems: 1, infinite: 'all' })));
});

test('what is missing is left out and said', () => {
  const data = study.make_study_data({ optimizers: 3, replicates: 4, problems: 2 });
  data.finished = false;
  data.progress = { done: 5, total: 24, unit: 'cells' };
  data.overall = null;
  data.verdict = [];
  for (const problem of data.problems) {
    problem.missing = 12;
    Object.assign(problem, { pairs: [], friedman: null, best_known: null, start: null, targets: [], order: [], front: null });
    for (const result of problem.results) {
      result.cells = [];
      result.running_times = [];
      result.ecdf = [];
      result.curve = { q1: [], median: [], q3: [] };
      Object.assign(result, { min: null, q1: null, median: null, q3: null, max: null, mean_rank: null, cases: null, final_check: null });
    }
  }
  const tabs = study.make_study_tabs(data);
  check_tabs(tabs);
  assert.match(find(tabs, 'headline').paragraphs[0], /no verdict yet/);
  assert.match(find(tabs, 'unfinished').paragraphs[0], /5 of 24 cells are done\. 24 runs have not ended/);
  assert.equal(find(tabs, 'pairs-q1-problem-1'), undefined);
  assert.match(find(tabs, 'values-q1-problem-1').caption, /Unfinished: 12 runs/);
  check_tabs(study.make_study_tabs({ ...data, problems: [] }));
  check_tabs(study.make_study_tabs({ ...data, problems: [], optimizers: [] }));
});

test('fixed targets are a table, fastest first, where the study has some', () => {
  const data = study.make_study_data({ optimizers: 3, replicates: 4, problems: 2 });
  check_tabs(study.make_study_tabs(data));
  assert.equal(find(study.make_study_tabs(data), 'targets-q1-problem-1'), undefined);
  const targets = ["'near' (error at most 0.3 mm)", "'far' (at most 0 of 10 test cases failing)"];
  const asked = study.make_study_data({ optimizers: 3, replicates: 4, problems: 2, targets });
  asked.problems[0].order.reverse();
  const tabs = study.make_study_tabs(asked);
  check_tabs(tabs);
  const { table } = find(tabs, 'targets-q1-problem-1');
  assert.equal(table.rows.length, 6);
  assert.deepEqual(table.rows[0], [targets[0], asked.optimizers[0].label, 4, 2, 4, 300, 300, null]);
  assert.deepEqual(
    table.rows.map((row) => row[5]),
    [300, 600, 900, 300, 600, 900],
  );
  asked.reference = asked.optimizers[1].label;
  const compared = find(study.make_study_tabs(asked), 'targets-q1-problem-1').table;
  assert.equal(compared.columns[8].label, 'times ' + asked.reference);
  assert.deepEqual(compared.rows[1].slice(8), [2, 0.5, null]);
});

test('every run is in the figure of values, those without value beyond the axis', () => {
  const data = study.make_study_data({ optimizers: 6, replicates: 15, problems: 1, infinite: 'some' });
  const lost = data.problems[0].results.reduce((sum, one) => sum + one.infinite, 0);
  assert.ok(lost > 0);
  const figure = find(study.make_study_tabs(data), 'values');
  const option = figure.draw(study.kLight, {});
  const points = option.series.find((one) => one.type === 'scatter').data;
  assert.equal(points.length, 90);
  const strip = option.series[0].markArea.data[0];
  const beyond = points.filter((point) => point.value[0] > strip[0].xAxis);
  assert.equal(beyond.length, lost);
  assert.ok(beyond.every((point) => point.value[0] < strip[1].xAxis && /no value/.test(point.note)));
  assert.ok(points.every((point) => point.command.startsWith('armwright rerun ')));
  assert.match(study.draw_svg(figure, study.kLight, {}, 640, 400), />no value</);
  // In millimetres, as drawn.
  const [row] = figure.table({}).rows;
  assert.equal(row[2].value, data.problems[0].results[data.problems[0].order[0]].cells[0].value * 1000);
});

test('hostile names are text only', () => {
  for (const name of ['</script><img src=x onerror=alert(1)>"\'&', '\u202e\u0000\n{b|x}', '__proto__', 'n'.repeat(4096), '…'.repeat(50)]) {
    const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 3, replicates: 4, problems: 2, fronts: true, name }));
    check_tabs(tabs);
    for (const figure of get_figures(tabs)) {
      const svg = study.draw_svg(figure, study.kLight, study.get_initial_picks(figure), 640, 400);
      assert.doesNotMatch(svg, /<img|<script|[\u0000-\u0008\u202e]/, figure.id);
      assert.ok(svg.length < 2_000_000);
      assert.ok(figure.title.length < 120 && figure.id.length < 80);
    }
  }
});

test('cliques are the longest stretches without a difference', () => {
  const pair = (a, b, significant) => ({ a, b, significant });
  // 0 and 2 are told apart, neighbours are not.
  const problem = { pairs: [pair(0, 1, false), pair(1, 2, false), pair(0, 2, true), pair(0, 3, true), pair(1, 3, true), pair(2, 3, true)] };
  assert.deepEqual(study.find_cliques(problem, [1, 2, 3, 4]), [
    [0, 1],
    [1, 2],
  ]);
  assert.deepEqual(study.find_cliques({ pairs: [] }, [2, 1]), [[1, 0]]);
});

test('labels of distinct points do not overlap', () => {
  const points = Array.from({ length: 10 }, (_, i) => [300 + 4 * i, 200 + 6 * (i % 3)]);
  const boxes = study.place_labels(
    points,
    points.map((_, i) => 'nlopt:label' + i),
    11,
    { x: 60, y: 20, width: 560, height: 340 },
  );
  boxes.forEach((a, i) =>
    boxes.slice(i + 1).forEach((b) => {
      const apart = a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
      assert.ok(apart, `${JSON.stringify(a)} ${JSON.stringify(b)}`);
    }),
  );
});

test('scales keep what has no value off the axis', () => {
  const scale = study.make_scale([0.2, 30, null], true, true);
  assert.ok(scale.log && scale.low < 0.2 && scale.high > 30 && scale.end > scale.high);
  assert.ok(scale.ticks.length >= 3 && scale.ticks.every((tick) => tick >= scale.low && tick <= scale.high));
  assert.ok(study.place_on(scale, null) > scale.high && study.place_on(scale, null) < scale.end);
  assert.equal(study.make_scale([-1, 5], true).log, false);
  assert.ok(study.make_scale([], true).ticks.length >= 3);
  assert.ok(study.make_scale([3, 3], true).ticks.length >= 2);
});

test('slugs are safe and unique', () => {
  assert.deepEqual(study.make_slugs(['Q1: a/b', 'q1 a b', '../..', '']), ['q1-a-b', 'q1-a-b-2', 'unnamed', 'unnamed-2']);
});

// A study whose problems have these tests of the leader: one text per problem, one letter per
// optimizer that is not the leader, in the order of the ranking. "w": the leader beats it, "b": it
// beats the leader, "-": not told apart. `leaders` has the index of each leader; default 0.
function make_decided(problems, leaders = [], more = {}) {
  const data = study.make_study_data({ optimizers: problems[0].length + 1, replicates: 15, problems: problems.length, infinite: 'none' });
  data.problems.forEach((problem, p) => {
    const leader = leaders[p] ?? 0;
    const others = data.optimizers.map((_, o) => o).filter((o) => o !== leader);
    problem.label = 'p' + (p + 1);
    problem.order = [leader, ...others];
    problem.pairs = others.map((o, i) => {
      const letter = problems[p][i];
      const [a, b] = letter === 'b' ? [o, leader] : [leader, o];
      return { a, b, p: 0.01, p_holm: 0.02, a12: 0.9, significant: letter !== '-', wins: 13, ties: 0, losses: 2 };
    });
  });
  'abcdefghijkl'.split('').forEach((name, o) => data.optimizers[o] && (data.optimizers[o].label = name));
  data.overall.mean_ranks = data.optimizers.map((_, o) => o + 1);
  return Object.assign(data, more);
}
const get_headline = (data) => {
  const [first] = study.make_study_tabs(data)[0].items;
  assert.equal(first.id, 'headline');
  assert.equal(first.paragraphs.length, 2);
  return first.paragraphs[0];
};

test('the headline says who is best, and who cannot be told apart from it', () => {
  const cases = [
    [['www'], [], 'a is best on p1: it beats every other optimizer.'],
    [['w-w'], [], 'a ranks best on p1; c cannot be told apart from it.'],
    [['www', 'www'], [], 'a is best on 2 of 2 problems, where it beats every other optimizer.'],
    [['--w', '--w'], [], 'a ranks best on 2 of 2 problems; b and c cannot be told apart from it on any of them.'],
    [['--w', '-ww'], [], 'a ranks best on 2 of 2 problems; b cannot be told apart from it on any of them, and c cannot on some of them.'],
    [['www', '-ww'], [], 'a ranks best on 2 of 2 problems; b cannot be told apart from it on some of them.'],
    [
      ['w--', '---'],
      [],
      'a ranks best on 1 of 2 problems; c and d cannot be told apart from it there; on 1 no two optimizers can be told apart.',
    ],
    [
      ['www', '-ww', 'www'],
      [0, 0, 1],
      'a ranks best on 2 of 3 problems; b cannot be told apart from it on some of them; b ranks best on 1.',
    ],
    [
      ['www', 'bww'],
      [],
      'a is best on 1 of 2 problems, where it beats every other optimizer; on 1 another optimizer beats the leader of the ranking.',
    ],
    [
      ['www', '-ww', 'www', '---'],
      [0, 1, 2],
      'a, b and c rank best on 1 of 4 problems each; on 1 of these, others cannot be told apart from the best one; on 1 no two optimizers can be told apart.',
    ],
    [
      ['www', 'www', 'www', 'www'],
      [0, 0, 1, 2],
      'a is best on 2 of 4 problems, where it beats every other optimizer; b and c rank best on 1 each.',
    ],
  ];
  for (const [problems, leaders, expected] of cases) {
    assert.equal(get_headline(make_decided(problems, leaders)), expected);
  }
});

test('the headline names the optimizers that failed, and those without a value', () => {
  const data = make_decided(['www', 'www'], []);
  const get_failures = () => study.make_study_tabs(data)[0].items[0].paragraphs[1];
  const set = (o, failed, infinite) => data.problems.forEach((problem) => Object.assign(problem.results[o], { failed, infinite }));
  [0, 1, 2, 3].forEach((o) => set(o, 0, 0));
  assert.equal(get_failures(), 'No optimizer failed, and every run has a value on the test set.');
  const runs = 2 * data.problems[0].results[1].cells.length;
  set(1, 2, 0);
  assert.equal(get_failures(), `Failed by a fault of their own: b in 4 of ${runs} runs.`);
  set(2, 0, 1);
  set(3, 0, 2);
  assert.equal(
    get_failures(),
    `Failed by a fault of their own: b in 4 of ${runs} runs. Without a value on the test set, because a simulation failed or a constraint is violated: d in 4 of ${runs} runs and c in 2 of ${runs} runs.`,
  );
  set(1, 0, 0);
  assert.match(get_failures(), /^No optimizer failed\. Without a value on the test set, because .*: d in 4 of/);
});

test('the headline claims nothing where the verdict decides nothing', () => {
  const cases = [
    [['---'], {}, 'No two optimizers can be told apart on p1.'],
    [['---', '---'], {}, 'No two optimizers can be told apart on any of the 2 problems.'],
    [['bw-'], {}, 'No optimizer is shown to be best on p1: b beats a, although a leads the ranking.'],
    [
      ['bw-', '---'],
      {},
      'No optimizer is shown to be best on any of the 2 problems: on 1 another optimizer beats the leader of the ranking; on 1 no two optimizers can be told apart.',
    ],
    [
      ['---'],
      { replicates: 5, fewest_replicates: 8 },
      'No pair of optimizers can be decided on p1 with 5 replicates; at least 8 are needed.',
    ],
    [
      ['---', '---'],
      { replicates: 1, fewest_replicates: 8 },
      'No pair of optimizers can be decided on any of the 2 problems with 1 replicate; at least 8 are needed.',
    ],
  ];
  for (const [problems, more, expected] of cases) {
    assert.equal(get_headline(make_decided(problems, [], more)), expected);
  }
  // The leader is told apart from none, though two others are told apart from each other.
  const open = make_decided(['---']);
  open.problems[0].pairs.push({ ...open.problems[0].pairs[0], a: 1, b: 3, significant: true });
  assert.equal(
    get_headline(open),
    'No optimizer is shown to be best on p1: a, which leads the ranking, cannot be told apart from any other.',
  );
  const lost = make_decided(['---']);
  lost.problems[0].results.forEach((one) => (one.infinite = one.cells.length));
  assert.equal(get_headline(lost), 'No optimizer found a design that has a value on the test set on p1.');
  const half = make_decided(['-ww', 'www']);
  half.problems[1].missing = 3;
  half.problems[1].pairs = [];
  assert.equal(get_headline(half), 'a ranks best on 1 of 2 problems; b cannot be told apart from it there; 1 problem is unfinished.');
  half.problems[0].missing = 1;
  assert.equal(get_headline(half), 'There is no verdict yet: runs on each of the 2 problems have not ended.');
  const one = study.make_study_data({ optimizers: 1, replicates: 5, problems: 1 });
  assert.equal(get_headline(one), 'There is nothing to compare: one optimizer took part.');
});

test('the headline names five optimizers at most', () => {
  assert.equal(get_headline(make_decided(['-------w'])), 'a ranks best on p1; b, c, d, e, f and 2 more cannot be told apart from it.');
  assert.match(
    get_headline(make_decided(['----ww', '------'.slice(0, 4) + '-w'])),
    /; b, c, d and e .* of them, and f cannot on some of them\.$/,
  );
  assert.match(get_headline(make_decided(['-----www', '-------w'])), /and 2 others cannot on some of them\.$/);
});

test('the grid shows the rank of every median and what the tests decide', () => {
  const data = make_decided(['w-b', 'w-w', '---']);
  data.problems[2].missing = 1;
  data.problems[2].pairs = [];
  data.problems[2].results.forEach((one) => (one.median_rank = null));
  const grid = find(study.make_study_tabs(data), 'standing');
  check_tabs(study.make_study_tabs(data));
  const { columns, rows } = grid.table({});
  assert.deepEqual(
    columns.map((column) => column.label),
    ['problem', 'optimizer', 'rank of the median', 'median', 'unit', 'standing', 'in words'],
  );
  const standing = (label) => rows.filter((row) => row[0] === label).map((row) => row[1] + ' ' + row[5]);
  assert.deepEqual(standing('p1'), [
    'a not told apart from the leader',
    'b worse than the leader',
    'c not told apart from the leader',
    'd better than the leader',
  ]);
  assert.deepEqual(standing('p2'), [
    'a ranks best',
    'b worse than the leader',
    'c not told apart from the leader',
    'd worse than the leader',
  ]);
  assert.deepEqual(standing('p3'), ['a no verdict', 'b no verdict', 'c no verdict', 'd no verdict']);
  assert.equal(rows[0][6], 'it leads the ranking, but its lead is not decided');
  assert.equal(rows[1][6], 'a beats it (A12 of a 0.90, p = 0.020 after Holm)');
  assert.equal(rows[3][6], 'it beats a, which leads the ranking (A12 of a 0.10, p = 0.020 after Holm)');
  assert.equal(rows[4][2], data.problems[1].results[0].median_rank);
  assert.equal(rows[4][3], data.problems[1].results[0].median * 1000);
  assert.equal(rows[8][2], null);
  // The legend has exactly the symbols that occur.
  const { legend, series } = grid.draw(study.kLight, {});
  assert.deepEqual(
    legend.data.map((entry) => entry.name),
    ['ranks best', 'not told apart', 'worse', 'better', 'no verdict'],
  );
  assert.equal(new Set(legend.data.map((entry) => entry.icon)).size, 5);
  assert.equal(series[0].data.length, 12);
  assert.match(series[0].data[0].note, /^a on p1; median .* mm, rank 1; it leads the ranking/);
});

test('the optimizer that is best on most problems is the first row of the grid', () => {
  const data = make_decided(['www', 'www', 'www'], [2, 2, 0]);
  const { rows } = find(study.make_study_tabs(data), 'standing').table({});
  assert.deepEqual(
    rows.slice(0, 4).map((row) => row[1]),
    ['c', 'a', 'b', 'd'],
  );
});

test('the grid has a name for every row, and its texts can be read on their cells', () => {
  const light = (part) => (part <= 10.31 ? part / 3294.6 : Math.pow((part / 255 + 0.055) / 1.055, 2.4));
  const get_luminance = (color) => {
    const parts = color.startsWith('#') ? [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16)) : color.match(/\d+/g).map(Number);
    return 0.2126 * light(parts[0]) + 0.7152 * light(parts[1]) + 0.0722 * light(parts[2]);
  };
  for (const optimizers of [12, 40]) {
    const data = study.make_study_data({ optimizers, replicates: 15, problems: 4, infinite: 'none' });
    const grid = find(study.make_study_tabs(data), 'standing');
    for (const look of [study.kLight, study.kDark]) {
      const svg = study.draw_svg(grid, look, {}, 1180, grid.height);
      data.optimizers.forEach(({ label }) => assert.ok(svg.includes('>' + label + '<'), label));
    }
  }
  for (let share = 0; share <= 1; share += 0.01) {
    for (const look of [study.kLight, study.kDark]) {
      const fill = study.mix(look.background, look.series[0], share);
      const both = [get_luminance(fill), get_luminance(study.get_readable(fill))].sort((a, b) => a - b);
      assert.ok((both[1] + 0.05) / (both[0] + 0.05) >= 4.5, `${fill}: ${(both[1] + 0.05) / (both[0] + 0.05)}`);
    }
  }
});

test('the grid names the problems, or numbers them where they have no room', () => {
  const find_grid = (problems) =>
    find(study.make_study_tabs(study.make_study_data({ optimizers: 3, replicates: 8, problems })), 'standing');
  const few = study.draw_svg(find_grid(3), study.kLight, {}, 300, 200);
  const many = find_grid(8);
  const narrow = study.draw_svg(many, study.kLight, {}, 300, 200);
  const wide = study.draw_svg(many, study.kLight, {}, 1180, 200);
  for (let p = 1; p <= 8; ++p) {
    assert.ok(wide.includes('>Q1 problem ' + p + '<') && !narrow.includes('problem'), `${p}`);
    assert.ok(narrow.includes('>' + p + '<'), `${p}`);
  }
  assert.ok(few.includes('>Q1 problem<') && !few.includes('>Q1 problem 1<'), 'broken into two lines');
  assert.match(many.caption, /In a narrow window the problems have numbers/);
  // Four names have two lines in a narrow window, between the legend and the cells.
  const { option } = study.fit_width(find_grid(4).draw(study.kLight, {}), 290, 200);
  const of_four = study.draw_svg(find_grid(4), study.kLight, {}, 290, 200);
  const above = Array.from(of_four.matchAll(/ y="([\d.]+)"[^>]*>([^<]*)</g)).filter(
    ([, y]) => y > 24 && y < find_grid(4).draw(study.kLight, {}).grid.top,
  );
  assert.equal(new Set(above.map(([, y]) => y)).size, 2, above.map(([, y, text]) => `${text} at ${y}`).join(', '));
  assert.equal(
    above
      .map(([, , text]) => text)
      .join('')
      .replace(/ /g, ''),
    'Q1problem1Q1problem2Q1problem3Q1problem4',
  );
  assert.ok(option.grid.top >= 4 + 14 + 5 + 2 * 13, `the cells begin at ${option.grid.top}`);
});

test('the verdict is folded away, whole', () => {
  const data = study.make_study_data({ optimizers: 3, replicates: 8, problems: 2 });
  data.verdict = ['One.', 'Two.'];
  const verdict = find(study.make_study_tabs(data), 'verdict');
  assert.equal(verdict.style, 'folded');
  assert.deepEqual(verdict.paragraphs, ['One.', 'Two.']);
});

test('tables leave out columns that have no value', () => {
  const data = study.make_study_data({ optimizers: 3, replicates: 4, problems: 2 });
  const get_labels = (id) => find(study.make_study_tabs(data), id).table.columns.map((column) => column.label);
  const overall = ['optimizer', 'mean rank', 'from', 'to', 'median, Q1 problem 1', 'median, Q1 problem 2'];
  assert.deepEqual(get_labels('overall'), overall);
  assert.ok(get_labels('cells-q1-problem-1').includes('time taken'));
  assert.ok(get_labels('cells-q1-problem-1').includes('CPU time'));
  assert.ok(get_labels('ranking-q1-problem-1').includes('checked on'));
  data.overall.rank_intervals = null;
  for (const problem of data.problems) {
    for (const result of problem.results) {
      result.final_check = null;
      result.cells.forEach((cell) => Object.assign(cell, { wall_s: null, cpu_s: null, failure: '', value: null }));
    }
  }
  check_tabs(study.make_study_tabs(data));
  assert.deepEqual(
    get_labels('overall'),
    overall.filter((label) => label !== 'from' && label !== 'to'),
  );
  assert.deepEqual(get_labels('cells-q1-problem-1'), [
    'optimizer',
    'replicate',
    'value',
    'cases',
    'evaluations',
    'failed test cases',
    'folder',
  ]);
  const ranking = get_labels('ranking-q1-problem-1');
  ['checked on', 'best design there', 'failures there'].forEach((label) => assert.ok(!ranking.includes(label), label));
  assert.ok(ranking.includes('median') && ranking.includes('mean rank'));
});
