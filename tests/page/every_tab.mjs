// What holds for every page: each tab opens, each chart is drawn, each table has a head, at two widths, at each in
// another theme. The tests of the layout and of access look at other pairs of a width and a theme.
import assert from 'node:assert/strict';
import { list_tabs, open_tab } from './browser.mjs';

async function check_tab(page, tab) {
  await open_tab(page, tab);
  await page.waitForFunction(() => Array.from(document.querySelectorAll('.plot')).every((plot) => plot.querySelector('svg') !== null));
  const cards = await page.$$eval('.card', (all) =>
    all.map((card) => ({
      id: card.dataset.figure,
      plot: card.querySelector('.plot') !== null,
      shapes: card.querySelectorAll('.plot svg path, .plot svg text').length,
      table: card.querySelector('table') !== null,
      headings: card.querySelectorAll('th').length,
      wide: card.scrollWidth > card.clientWidth + 1,
    })),
  );
  assert.ok(cards.length > 0, `tab ${tab} is empty`);
  for (const card of cards) {
    assert.ok(card.id, `a card of tab ${tab} has no name`);
    assert.ok(!card.plot || card.shapes > 5, `${card.id} in tab ${tab} shows no chart`);
    assert.ok(!card.table || card.headings > 0, `table ${card.id} in tab ${tab} has no head`);
    assert.ok(!card.wide, `${card.id} in tab ${tab} is wider than its card`);
  }
  const sideways = await page.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth + 1);
  assert.ok(!sideways, `tab ${tab} scrolls sideways`);
  return cards.map((card) => card.id);
}

// Returns the names of all figures and tables. Calls `look` with the name of each tab while the tab is open.
export async function check_every_tab(page, look = async () => {}) {
  const found = [];
  for (const width of [1280, 1920]) {
    await page.setViewportSize({ width, height: 900 });
    const names = [];
    for (const tab of await list_tabs(page)) {
      names.push(...(await check_tab(page, tab)));
      await look(tab);
    }
    found.splice(0, found.length, ...names);
    await page.click('.theme');
  }
  await page.setViewportSize({ width: 1280, height: 900 });
  assert.equal(new Set(found).size, found.length, 'two figures have one name');
  return found;
}
