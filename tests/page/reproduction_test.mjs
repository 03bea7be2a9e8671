import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open_browser, open_page } from './browser.mjs';
import { kFolder } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

test('the first screen has the sentence, and the reasons of differences', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'reproduction.html'));
  const cards = await page.$$eval('main .card', (all) => all.map((card) => card.dataset.figure));
  assert.deepEqual(cards.slice(0, 2), ['headline', 'agreement']);
  const headline = await page.locator('[data-figure=headline] p').innerText();
  const rows = await page.$$eval('[data-figure=agreement] tbody tr', (all) =>
    all.map((row) => Array.from(row.cells).map((cell) => cell.textContent)),
  );
  assert.ok(
    headline.startsWith(`${rows.filter((row) => row[5] === '✓ agrees').length} of the ${rows.length} published numbers agree`),
    headline,
  );
  const step = rows.find((row) => row[0] === 'A.9');
  assert.equal(step[5], '▲ larger');
  assert.match(step[6], /thesis's own physics engine/);
  // Each published number of Tables 6.1 and 6.4 and of the figures.
  assert.equal(rows.length, 17);
  expect_no_faults();
  await page.close();
});

test("the thesis's numbers stand beside ours", async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'reproduction.html'));
  const text = await page.locator('main').innerText();
  for (const published of ['5.8', '12.6', '0.083', '269.9', '963686', '28927']) {
    assert.ok(text.includes(published), `${published} is not on the first tab`);
  }
  expect_no_faults();
  await page.close();
});
