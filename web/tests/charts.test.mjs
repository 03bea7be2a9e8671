// What the figures are put together from.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const { decimate, shorten, shorten_all } = await load(`
  export { decimate } from './src/charts/decimate';
  export { shorten, shorten_all } from './src/charts/names';
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
