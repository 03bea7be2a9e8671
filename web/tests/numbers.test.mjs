// Numbers as they are shown, unpacked and written into files.
import assert from 'node:assert/strict';
import test from 'node:test';
import { load } from './load.mjs';

const { format_duration, format_number, unpack, unpack_indices, to_csv } = await load(`
  export { format_duration, format_number, unpack, unpack_indices } from './src/numbers';
  export { to_csv } from './src/csv';
`);

test('numbers have so many digits, and an exponent only where that is shorter', () => {
  assert.equal(format_number(0.07412345), '0.07412');
  assert.equal(format_number(1040562.3), '1040562');
  assert.equal(format_number(-5.7468, 3), '-5.75');
  assert.equal(format_number(0.99999), '1.000');
  assert.equal(format_number(0.00000025, 2), '2.5e-7');
  assert.equal(format_number(0), '0');
  assert.equal(format_number(140), '140');
});

test('durations have the units that a person would say', () => {
  assert.deepEqual([0, 0.4234, 9.94, 9.96, 59.4, 59.6, 185, 599.4, 599.6, 3569, 3571, 7830].map(format_duration), [
    '0 s',
    '0.42 s',
    '9.9 s',
    '10 s',
    '59 s',
    '1 min 0 s',
    '3 min 5 s',
    '9 min 59 s',
    '10 min',
    '59 min',
    '1 h 0 min',
    '2 h 11 min',
  ]);
});

test('what does not exist is a dash, never a number', () => {
  for (const none of [null, undefined, NaN, Infinity, -Infinity]) {
    assert.equal(format_number(none), '–');
  }
});

test('packed numbers come out as they went in', () => {
  const base64 = (array) => Buffer.from(array.buffer).toString('base64');
  for (let length = 0; length < 5; ++length) {
    const values = Float32Array.from({ length }, (_, i) => Math.fround(i * 1.7 - 3));
    assert.deepEqual(unpack({ f32: base64(values) }), values);
    const indices = Uint32Array.from({ length }, (_, i) => 4_000_000_000 + i);
    assert.deepEqual(unpack_indices({ u32: base64(indices) }), indices);
  }
  assert.deepEqual(unpack({ i16: base64(Int16Array.of(-2, 0, 5)), scale: 0.5, offset: 1 }), Float32Array.of(0, 1, 3.5));
});

test('tables are CSV that no spreadsheet runs', () => {
  const table = {
    columns: [{ label: 'name' }, { label: 'error', unit: 'mm', numeric: true }],
    rows: [
      ['plain', 1.5],
      ['a "b", c\nd', null],
      ['=cmd|calc!A1', -0.25],
      [{ value: '@SUM(1)', command: 'armwright' }, { value: 2 }],
    ],
  };
  assert.equal(to_csv(table), 'name,error (mm)\r\nplain,1.5\r\n"a ""b"", c\nd",\r\n\'=cmd|calc!A1,-0.25\r\n\'@SUM(1),2\r\n');
});
