// The grades of the published numbers and the sentence above them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './load.mjs';

const { grade_agreement, make_agreement_headline, make_agreement_table, make_page, make_reproduction_data } = await load(`
  export { grade_agreement, make_agreement_headline, make_agreement_table } from './src/figures/agreement';
  export { make_page } from './src/figures/page';
  export { make_reproduction_data } from './tests/fixtures/pages';
`);

test('a number agrees within a tenth or within two standard errors', () => {
  assert.equal(grade_agreement(11, 10, 0), 'agrees');
  assert.equal(grade_agreement(9, 10, 0), 'agrees');
  assert.equal(grade_agreement(11.01, 10, 0.4), 'larger');
  assert.equal(grade_agreement(8.99, 10, 0.4), 'smaller');
  assert.equal(grade_agreement(11.99, 10, 1), 'agrees');
  assert.equal(grade_agreement(12.01, 10, 1), 'larger');
  assert.equal(grade_agreement(null, 10, 1), 'missing');
});

function make_data() {
  const data = make_reproduction_data();
  const row = { ...data.rows[0], published_torque_n_m: null };
  const make_row = (label, published_error_m, mean_m, reason) => ({ ...row, label, design: label, published_error_m, mean_m, reason });
  return {
    ...data,
    rows: [
      make_row('near', 0.01, 0.0105, 'never shown'),
      make_row('worse', 0.01, 0.03, 'It is fragile.'),
      make_row('better', 0.01, 0.005, ''),
      make_row('lost', 0.01, null, ''),
      make_row('not printed', null, 0.01, ''),
      { ...make_row('near', null, 0.01, ''), label: 'near, with load', published_torque_n_m: 100, torque_n_m: 101 },
      { ...make_row('near', null, 0.01, ''), label: 'near, twice', published_torque_n_m: 100, torque_n_m: 101 },
    ],
    runs: [{ ...data.runs[0], torque_n_m: 30000, reason: 'Another design.' }],
  };
}

test('the standard error does not count if a case failed', () => {
  const data = make_data();
  const grade = (failures) => {
    const rows = [{ ...data.rows[1], standard_error_m: 0.02, failures }];
    return make_agreement_table({ ...data, rows, runs: [] }).table.rows[0][5].value;
  };
  assert.equal(grade(0), '✓ agrees');
  assert.equal(grade(1), '▲ larger');
});

test('the table has each published number once, with symbol, word and reason', () => {
  const { table, caption } = make_agreement_table(make_data());
  const plain = table.rows.map((row) => row.map((cell) => (cell !== null && typeof cell === 'object' ? cell.value : cell)));
  assert.deepEqual(plain, [
    ['near', 'mean error (mm)', 10, 10.5, 1.05, '✓ agrees', null],
    ['worse', 'mean error (mm)', 10, 30, 3, '▲ larger', 'It is fragile.'],
    ['better', 'mean error (mm)', 10, 5, 0.5, '▼ smaller', 'not explained'],
    ['lost', 'mean error (mm)', 10, null, null, '? no number', null],
    ['near, with load', 'total torque (kN m)', 0.1, 0.101, 1.01, '✓ agrees', null],
    ['E1', 'total torque (kN m)', 22.104, 30, 30 / 22.104, '▲ larger', 'Another design.'],
  ]);
  assert.deepEqual(
    table.rows.map((row) => row[5].mark),
    ['good', 'bad', 'near', 'none', 'good', 'bad'],
  );
  assert.match(caption, /at most 10 % of it, or by at most two standard errors/);
});

test('one sentence counts the grades and names what differs', () => {
  assert.deepEqual(make_agreement_headline(make_data()).paragraphs, [
    '2 of the 6 published numbers agree with ours; ours is smaller for 1 (better); ours is larger for 2 (worse and E1); ' +
      'ours has no number for 1; 1 of these differences is not explained.',
  ]);
  const data = make_data();
  const all_known = { ...data, rows: data.rows.filter((row) => row.label !== 'better' && row.label !== 'lost') };
  assert.match(make_agreement_headline(all_known).paragraphs[0], /; every difference has a known reason\.$/);
  const good = { ...data, rows: data.rows.slice(0, 1), runs: [] };
  assert.deepEqual(make_agreement_headline(good).paragraphs, ['1 of the 1 published numbers agree with ours.']);
  assert.equal(make_agreement_headline({ ...data, rows: [], runs: [] }), null);
});

test('the page begins with the sentence and the table', () => {
  const ids = make_page(make_data()).tabs[0].items.map((item) => item.id);
  assert.deepEqual(ids.slice(0, 2), ['headline', 'agreement']);
});
