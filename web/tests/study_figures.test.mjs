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

function check_tabs(tabs, looks = [study.kLight, study.kDark]) {
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
    for (const picked of list_picks(item)) {
      check_table(item.table(picked), item.id);
      for (const look of looks) {
        const svg = study.draw_svg(item, look, picked, 640, 400);
        assert.ok(svg.startsWith('<svg') && svg.endsWith('</svg>'), item.id);
        assert.doesNotMatch(svg, /NaN|undefined|Infinity/, item.id);
      }
    }
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
    ['ranks', 'convergence', 'values', 'runtime-ecdf', 'cost-quality', 'pairs', 'data-profile', 'performance-profile', 'parallel'],
  );
  for (const id of ['ranking', 'running-times', 'pairs-table', 'cells']) {
    assert.equal(find(tabs, id).kind, 'table');
  }
  check_tabs(tabs);
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

test('forty optimizers with fifteen replicates draw, the best eight at first', () => {
  const tabs = study.make_study_tabs(study.make_study_data({ optimizers: 40, replicates: 15, problems: 1 }));
  check_tabs(tabs);
  const option = find(tabs, 'convergence').draw(study.kLight, {});
  assert.equal(option.legend.data.length, 40);
  assert.equal(Object.values(option.legend.selected).filter(Boolean).length, 8);
  const names = find(tabs, 'ranking')
    .table.rows.slice(0, 8)
    .map((row) => row[0]);
  assert.deepEqual(
    names.filter((name) => !option.legend.selected[name]),
    [],
  );
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
  assert.match(find(tabs, 'unfinished').paragraphs[0], /5 of 24 cells are done\. 24 runs have not ended/);
  assert.equal(find(tabs, 'pairs-q1-problem-1'), undefined);
  assert.match(find(tabs, 'values-q1-problem-1').caption, /Unfinished: 12 runs/);
  check_tabs(study.make_study_tabs({ ...data, problems: [] }));
  check_tabs(study.make_study_tabs({ ...data, problems: [], optimizers: [] }));
});

test('captions say that running times are as coarse as the checkpoints only where they are', () => {
  const get_caption = (exact_times, id) =>
    find(study.make_study_tabs(study.make_study_data({ optimizers: 3, replicates: 4, problems: 2, exact_times })), id).caption;
  for (const id of ['runtime-ecdf-q1-problem-1', 'cost-quality-q1-problem-1']) {
    assert.match(get_caption(false, id), /as coarse as the checkpoints, because some runs were recorded by version 1\.0/);
    assert.doesNotMatch(get_caption(true, id), /checkpoints/);
  }
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
    check_tabs(tabs, [study.kLight]);
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
