// The filter of a comparison's optimizers.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './load.mjs';

const { choose_shown, draw_svg, get_family, get_initial_picks, kLight, make_page, make_study_data } = await load(`
  export { draw_svg, get_initial_picks } from './src/charts/svg';
  export { kLight } from './src/charts/look';
  export { choose_shown, get_family } from './src/app/filter_view';
  export { make_page } from './src/figures/page';
  export { make_study_data } from './tests/fixtures/study_data';
`);

const data = make_study_data({ optimizers: 40, replicates: 6, problems: 2 });
const kAll = { text: '', hidden: [], best: false };
const name = (shown) => shown.optimizers.map((o) => data.optimizers[o].label);

test('names match by a part, by a pattern, and by family', () => {
  assert.deepEqual(name(choose_shown(data, { ...kAll, text: 'CMA' })), ['cmaes']);
  assert.deepEqual(name(choose_shown(data, { ...kAll, text: 'nlopt:*, cma' })), [
    'cmaes',
    'nlopt:cobyla',
    'nlopt:sbplx',
    'nlopt:bobyqa',
    'nlopt:crs2_lm',
    'nlopt:esch',
  ]);
  assert.deepEqual(name(choose_shown(data, { ...kAll, text: 'optimizer' })).length, 28);
  assert.deepEqual(name(choose_shown(data, { ...kAll, text: '?a' })), ['ga']);
  assert.deepEqual(name(choose_shown(data, { ...kAll, hidden: ['nlopt', 'armwright'] })), [
    'ceres:lm',
    'pagmo:pso_gen',
    'pagmo:gaco',
    'pagmo:sade',
  ]);
  assert.equal(get_family('nlopt:cobyla'), 'nlopt');
  assert.equal(get_family('cmaes'), 'armwright');
  // Characters of regular expressions are characters of names.
  assert.deepEqual(name(choose_shown(data, { ...kAll, text: '(baseline)' })), ['random (baseline)']);
  assert.equal(choose_shown(data, { ...kAll, text: '[' }).optimizers.length, 40);
});

test('the sentence says how many of how many are shown', () => {
  const say = (filter, of = data) => choose_shown(of, { ...kAll, ...filter }).sentence;
  assert.equal(say({ best: true }), '12 of 40 optimizers are shown: the best 12.');
  assert.equal(say({}), '40 of 40 optimizers are shown.');
  assert.equal(say({ text: 'optimizer', best: true }), '12 of 40 optimizers are shown: the best 12 of 28 that match.');
  assert.equal(say({ text: 'cma', best: true }), '1 of 40 optimizers are shown.');
  assert.equal(say({ text: 'xyz', best: true }), '12 of 40 optimizers are shown, because no name matches.');
  assert.equal(say({ best: true }, make_study_data({ optimizers: 4, replicates: 6, problems: 1 })), '4 of 4 optimizers are shown.');
});

test('the best are those with the best mean ranks', () => {
  const shown = choose_shown(data, { ...kAll, best: true }).optimizers;
  const worst = Math.max(...shown.map((o) => data.overall.mean_ranks[o]));
  const others = data.overall.mean_ranks.filter((_, o) => !shown.includes(o));
  assert.ok(others.every((rank) => rank >= worst));
});

// Returns the names in a table that are those of optimizers.
function list_named(table) {
  const labels = data.optimizers.map((one) => one.label);
  const cells = table.rows.flat().map((cell) => (cell !== null && typeof cell === 'object' ? cell.value : cell));
  return [...new Set(cells.filter((cell) => labels.includes(cell)))].sort();
}

test('every figure and table has the shown optimizers only, and the headline is that of all', () => {
  const shown = [1, 7, 20];
  const names = shown.map((o) => data.optimizers[o].label).sort();
  const items = make_page(data, shown).tabs.flatMap((tab) => tab.items);
  const whole = make_page(data).tabs.flatMap((tab) => tab.items);
  assert.deepEqual(
    items.map((item) => item.id),
    whole.map((item) => item.id),
  );
  for (const item of items) {
    if (item.kind === 'figure' || item.kind === 'table') {
      const picks = item.kind === 'figure' ? get_initial_picks(item) : {};
      const found = list_named(item.kind === 'figure' ? item.table(picks) : item.table);
      assert.ok(found.length > 0, item.id);
      assert.deepEqual(found.filter((one) => !names.includes(one)), [], item.id); // prettier-ignore
    }
    if (item.kind === 'figure') {
      const svg = draw_svg(item, kLight, get_initial_picks(item), 640, 400);
      assert.doesNotMatch(svg, />optimizer 3[0-9]</, item.id);
    }
  }
  const find = (list, id) => list.find((item) => item.id === id);
  assert.deepEqual(find(items, 'headline').paragraphs, find(whole, 'headline').paragraphs);
  // Ranks stay those among all.
  const ranks = (list) => Object.fromEntries(find(list, 'overall').table.rows.map((row) => [row[0], row[1]]));
  for (const [one, rank] of Object.entries(ranks(items))) {
    assert.equal(rank, ranks(whole)[one]);
  }
  // A single optimizer draws, too.
  for (const item of make_page(data, [39])
    .tabs.flatMap((tab) => tab.items)
    .filter((one) => one.kind === 'figure')) {
    assert.doesNotMatch(draw_svg(item, kLight, get_initial_picks(item), 640, 400), /NaN|undefined|Infinity/, item.id);
  }
});
