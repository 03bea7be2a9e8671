// The pages that compare two runs and two studies.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open_browser, open_page, open_tab } from './browser.mjs';
import { kFolder } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

test('two runs: the first screen says which one is better, and both move together', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'comparison.html'));
  const headline = await page.locator('[data-figure=headline]').innerText();
  assert.match(headline, /[AB] has the smaller mean error at rest on the test set: [\d.]+ mm against [\d.]+ mm/);
  assert.match(headline, /A is better in \d+ of 500 and B in \d+; /);
  assert.match(headline, /tested on the same cases, but the budget differs/);
  assert.deepEqual(await page.locator('.summary > h3', { hasText: /^[AB]: / }).allInnerTexts(), [
    'A: ga on q1-complex',
    'B: cmaes on q1-complex',
  ]);
  const row = page.locator('[data-figure=differences] tr', { hasText: 'run.budget' });
  assert.match(await row.innerText(), /1400\s+700/);
  await open_tab(page, 'motion');
  assert.deepEqual(
    await page
      .locator('.replay label', { hasText: /^Design/ })
      .locator('option')
      .allInnerTexts(),
    ['winner of A', 'winner of B'],
  );
  expect_no_faults();
  await page.close();
});

test('two studies: what both have is compared', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'study-comparison.html'));
  const headline = await page.locator('[data-figure=headline]').innerText();
  assert.match(headline, /The studies are comparable/);
  assert.match(headline, /Only A has nlopt:bobyqa and q2-e6/);
  assert.equal(await page.locator('[data-figure=compared-cells] tbody tr').count(), 4); // ga, cmaes, start and random on q1-complex
  expect_no_faults();
  await page.close();
});
