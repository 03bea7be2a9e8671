// The page of an identification, on made-up data: the drawings themselves are checked by run_figures.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const { get_initial_picks, kLight, kPeriod_s, make_identification_data, make_page } = await load(`
  export { get_initial_picks } from './src/charts/svg';
  export { kLight } from './src/charts/look';
  export { make_page } from './src/figures/page';
  export { kPeriod_s, make_identification_data } from './tests/fixtures/identification';
`);

const get_tabs = (data) => make_page(data).tabs;
const find = (data, id) => {
  const item = get_tabs(data)
    .flatMap((tab) => tab.items)
    .find((one) => one.id === id);
  assert.ok(item, `there is no ${id}`);
  return item;
};
const change = (changes) => {
  const data = make_identification_data();
  return { ...data, identification: { ...data.identification, ...changes } };
};

test('an identification has its own tabs, and none of a design that is tuned', () => {
  assert.deepEqual(
    get_tabs(make_identification_data()).map((tab) => tab.id),
    ['overview', 'motion', 'parameters', 'search'],
  );
});

test('doubts come first, each as a sentence, and their absence is said', () => {
  const [first] = get_tabs(make_identification_data())[0].items;
  assert.equal(first.id, 'doubts');
  assert.equal(first.verdict.mark, 'near');
  assert.deepEqual(
    first.lines.map((line) => line.value),
    ['A parameter is at the end of the range that is searched: joint_2 armature.'],
  );
  assert.equal(find(change({ doubts: [] }), 'doubts').verdict.mark, 'good');
});

test('the headline has the errors on logs held back and on fitted ones', () => {
  const tiles = find(make_identification_data(), 'identification').tiles;
  assert.deepEqual(
    tiles.slice(0, 2).map((tile) => [tile.label, tile.value]),
    [
      ['Error on logs held back', '0.500 → 0.120'],
      ['Error on fitted logs', '0.500 → 0.100'],
    ],
  );
  assert.match(tiles[0].detail, /0\.240 times .*b\.csv$/);
  assert.match(tiles[2].detail, /^1 cannot be told from the motions; 1 may be 0; 1 at the end of the range$/);
  const without = find(change({ held_back: null }), 'identification').tiles;
  assert.equal(without[0].label, 'Error on fitted logs');
  const worse = { ...make_identification_data().identification.fitted, error_after: 0.6 };
  assert.equal(find(change({ held_back: worse }), 'identification').tiles[0].mark, 'bad');
});

test('the joints say on which logs they were judged, and how long residuals repeat', () => {
  const { rows } = find(make_identification_data(), 'fit-table').table;
  assert.equal(rows.length, 8);
  assert.deepEqual(
    rows.map((row) => row[1]),
    [...Array(4).fill('fitted'), ...Array(4).fill('held back')],
  );
  assert.equal(rows[0][7].value, '✓ white');
  assert.equal(rows[1][7].value, '! repeat over 0.40 s');
});

test('a parameter says whether it was told, and the strongest correlation comes first', () => {
  const { caption, table } = find(make_identification_data(), 'parameters-table');
  assert.deepEqual(
    table.rows.map((row) => row[6].value),
    ['✓ told', '! at the end of its range', '? cannot be told', '? may be 0', '✓ told'],
  );
  assert.match(caption, / payload\.z cannot be told from these motions\.$/);
  const pairs = find(make_identification_data(), 'correlations-table').table.rows;
  assert.deepEqual(
    pairs.map((row) => row[2]),
    [0.99, -0.93],
  );
});

test('intervals are shares of the value, also of a negative one, and cut at the ends', () => {
  const figure = find(make_identification_data(), 'intervals');
  // A value of 0, or none, has no shares.
  assert.deepEqual(
    figure.table({}).rows.map((row) => row.map((cell) => (typeof cell === 'number' ? Math.round(cell) : cell))),
    [
      ['joint_1 viscous friction', 90, 110, 50],
      ['joint_2 armature', 75, 125, 75],
      ['payload centre z', -8800, 9000, -0],
    ],
  );
  const [spans] = figure.draw(kLight, {}).series;
  assert.deepEqual(spans.data[2], [2, -100, 300]);
});

test('the torques open with a log held back, and residuals stand below them at the same times', () => {
  const figure = find(make_identification_data(), 'efforts');
  const picked = { ...get_initial_picks(figure), joint: '1' };
  assert.equal(picked.log, 'log-2');
  assert.equal(figure.time.case(picked), 'log-2');
  assert.equal(figure.time.case({ ...picked, log: 'log-1' }), 'log-1');
  const { columns, rows } = figure.table(picked);
  assert.deepEqual(
    columns.map((column) => column.label),
    ['time', 'recorded', 'model before', 'model after', 'residual before', 'residual after'],
  );
  const [time, recorded, before, after, old_rest, new_rest] = rows[10];
  assert.ok(Math.abs(time - 10 * kPeriod_s) < 1e-12);
  assert.ok(Math.abs(recorded - 200 * Math.sin((time * 3) / 2 + 1)) < 1e-3, `${recorded}`);
  assert.ok(Math.abs(old_rest - (recorded - before)) < 1e-3 && Math.abs(new_rest - (recorded - after)) < 1e-3);
  const { series, xAxis } = figure.draw(kLight, picked, { from: 2, to: 4 });
  assert.deepEqual(
    xAxis.map((axis) => axis.gridIndex),
    [0, 1],
  );
  assert.deepEqual(
    series.map((one) => one.xAxisIndex),
    [0, 0, 0, 1, 1],
  );
  const times = series[0].data.map((point) => point[0]);
  assert.ok(times[0] <= 2 && times[times.length - 1] >= 4 && times.length < 60, `${times.length}`);
});
