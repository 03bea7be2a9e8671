// What the figures are put together from.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const {
  can_zoom,
  decimate,
  fit_width,
  kLight,
  kNarrow_px,
  make_axis,
  make_chart,
  make_line,
  make_panels,
  read_curves,
  shorten,
  shorten_all,
  zoom_in,
} = await load(`
  export { decimate } from './src/charts/decimate';
  export { kLight } from './src/charts/look';
  export { make_panels } from './src/charts/marks';
  export { shorten, shorten_all } from './src/charts/names';
  export { fit_width, kNarrow_px } from './src/charts/narrow';
  export { make_axis, make_chart, make_line } from './src/charts/parts';
  export { can_zoom, read_curves, zoom_in } from './src/charts/zoom';
`);

test('decimation keeps both ends and every extreme', () => {
  const values = Float32Array.from({ length: 10007 }, (_, i) => Math.sin(i / 50));
  values[1234] = 9;
  values[8888] = -9;
  const kept = decimate(values, 200);
  assert.ok(kept.length <= 200, `${kept.length}`);
  [0, 1234, 8888, 10006].forEach((i) => assert.ok(kept.includes(i), `${i}`));
  kept.slice(1).forEach((index, i) => assert.ok(index > kept[i], 'in order, none twice'));
});

test('decimation passes over what is no number', () => {
  const values = Float32Array.from({ length: 5000 }, (_, i) => (i % 3 === 0 ? NaN : i === 2501 ? 7 : 0));
  assert.ok(decimate(values, 100).includes(2501));
});

test('short series stay whole', () => {
  assert.deepEqual(decimate([3, 1, 2], 3), [0, 1, 2]);
  assert.deepEqual(decimate([], 3), []);
});

test('long names end in an ellipsis, within their length', () => {
  assert.equal(shorten('short'), 'short');
  assert.equal(shorten('a'.repeat(41)), 'a'.repeat(39) + '…');
  assert.equal(shorten('a'.repeat(40)), 'a'.repeat(40));
  // A surrogate pair at the cut is left out as a whole.
  assert.equal(shorten('a'.repeat(38) + '\u{1f600}'.repeat(4)), 'a'.repeat(38) + '…');
});

test('what turns the text around or cannot be seen is gone', () => {
  assert.equal(shorten('a\u202eb\u0000c\nd'), 'a b c d');
});

test('names beside each other stay different', () => {
  const long = 'x'.repeat(60);
  const names = shorten_all([long + '1', long + '2', '', '']);
  assert.equal(new Set(names).size, 4);
  names.forEach((name) => assert.ok(name.length > 0 && name.length <= 40, name));
});

const make_axes = (count) => Array.from({ length: count }, (_, i) => make_axis(kLight, 'x', 'time (s)', { index: i }));

test('a wide chart stays as it is', () => {
  const option = make_chart(kLight, make_axes(1), make_axes(1), [{ name: 'a' }, { name: 'b' }]);
  assert.deepEqual(fit_width(option, kNarrow_px, 340), { option, height_px: 340 });
});

test('in a narrow chart the legend is above the curves, which keep their height', () => {
  const beside = { type: 'scroll', orient: 'vertical', right: 6, top: 14, bottom: 14, data: ['a', 'b'], textStyle: { fontSize: 11 } };
  const drawn = make_chart(kLight, make_axes(1), make_axes(1), [], { grid: { left: 68, right: 216, top: 20, bottom: 48 }, legend: beside });
  const { option, height_px } = fit_width(drawn, 330, 340);
  assert.equal(option.legend.orient, 'horizontal');
  assert.equal(option.legend.type, 'plain');
  assert.ok(option.grid.left + option.grid.right < 100, JSON.stringify(option.grid));
  assert.ok(option.grid.top > 40);
  assert.equal(height_px - option.grid.top - option.grid.bottom, 340 - 20 - 48);
});

test('each row of a legend makes a narrow chart higher, and a very long legend keeps its pages', () => {
  const draw = (count) => {
    const names = Array.from({ length: count }, (_, i) => `optimizer ${i}`);
    return fit_width(
      make_chart(
        kLight,
        make_axes(1),
        make_axes(1),
        names.map((name) => ({ name })),
      ),
      330,
      340,
    );
  };
  assert.ok(draw(12).height_px > draw(6).height_px);
  assert.equal(draw(12).option.legend.type, 'plain');
  assert.equal(draw(40).option.legend.type, 'scroll');
  assert.ok(draw(40).height_px < 400);
});

test('panels of a narrow chart stand below each other', () => {
  const grid = make_panels(6, 3, 480);
  const title = grid.map((one, i) => ({ text: `panel ${i}`, left: one.left, top: one.top }));
  const { option, height_px } = fit_width(make_chart(kLight, make_axes(6), make_axes(6), [], { grid, title }), 330, 480);
  option.grid.slice(1).forEach((one, i) => {
    assert.equal(one.left, option.grid[i].left);
    assert.ok(one.top > option.grid[i].top + option.grid[i].height);
    assert.equal(option.title[i + 1].top, one.top);
  });
  assert.ok(height_px > option.grid[5].top + option.grid[5].height);
  assert.deepEqual(
    option.xAxis.map((axis) => axis.name !== ''),
    [false, false, false, false, false, true],
  );
});

const make_curves = (lists, y = {}) =>
  make_chart(
    kLight,
    [make_axis(kLight, 'x', 'time (s)')],
    [make_axis(kLight, 'y', 'error (mm)', y)],
    lists.map((points, i) => make_line(kLight, i, `curve ${i}`, points)),
  );
const kSlope = [
  [0, 0],
  [1, 10],
  [2, 100],
  [3, 1000],
];

test('curves are read between their points, each at the same place', () => {
  const level = [
    [0.5, 4],
    [1.7, null],
    [2.5, 8],
  ];
  const read = (x, selected) => read_curves(make_curves([kSlope, level]), 0, x, selected).map((one) => [one.name, one.value]);
  assert.deepEqual(read(0.5), [
    ['curve 0', 5],
    ['curve 1', 4],
  ]);
  assert.deepEqual(read(3), [['curve 0', 1000]]);
  assert.deepEqual(read(3.1), []);
  assert.deepEqual(read(1.7), [['curve 0', 73]]);
  assert.deepEqual(read(0.5, { 'curve 0': false }), [['curve 1', 4]]);
  const [on_log] = read_curves(make_curves([kSlope], { log: true }), 0, 1.5);
  assert.ok(Math.abs(on_log.value - Math.sqrt(1000)) < 1e-9, `${on_log.value}`);
});

test('a zoom shows the range and the values in it, and leaves other panels alone', () => {
  const drawn = make_curves([
    kSlope,
    [
      [0, -9999],
      [3, -9999],
    ],
  ]);
  const { xAxis, yAxis } = zoom_in(kLight, drawn, [{ from: 1, to: 2 }]);
  assert.deepEqual([xAxis[0].min, xAxis[0].max], [1, 2]);
  assert.ok(yAxis[0].min <= 10 && yAxis[0].min >= 0 && yAxis[0].max >= 100 && yAxis[0].max < 120, `${yAxis[0].min} to ${yAxis[0].max}`);
  assert.ok(xAxis[0].axisLabel.customValues.every((tick) => tick >= 1 && tick <= 2));
  assert.ok(yAxis[0].axisTick.customValues.length >= 3);
  assert.deepEqual(zoom_in(kLight, drawn, [null]), drawn);
});

test('only curves over a growing number can be zoomed', () => {
  assert.ok(can_zoom(make_curves([kSlope])));
  assert.ok(!can_zoom(make_curves([[...kSlope, [1, 5]]])));
  assert.ok(!can_zoom(make_curves([kSlope.slice(0, 2)])));
  const categories = { ...make_curves([kSlope]), xAxis: [make_axis(kLight, 'x', '', { categories: ['a', 'b', 'c', 'd'] })] };
  assert.ok(!can_zoom(categories));
});
