// The page for readers who use the keyboard, a narrow screen, or prefer less motion.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { draw_frames, list_tabs, open_browser, open_page, open_tab } from './browser.mjs';
import { find_motion, settle, walk } from './examine.mjs';
import { kFolder } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser({ reducedMotion: 'reduce' });
});
after(() => browser.close());

test('the keyboard alone: a link past the tabs, arrows between them, sorted tables, a visible focus', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.textContent), 'To the contents');
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute('role')), 'tabpanel');

  const tabs = await list_tabs(page);
  const get_tab = () => page.evaluate(() => document.activeElement.dataset.tab);
  await page.keyboard.press('Shift+Tab');
  for (const [key, tab] of [
    ['ArrowRight', tabs[1]],
    ['End', tabs.at(-1)],
    ['ArrowRight', tabs[0]],
    ['ArrowLeft', tabs.at(-1)],
    ['Home', tabs[0]],
    ['End', tabs.at(-1)],
  ]) {
    await page.keyboard.press(key);
    assert.equal(await get_tab(), tab, key);
    assert.equal(await page.locator('[role=tabpanel]').getAttribute('aria-labelledby'), `tab-${tab}`);
  }
  assert.equal(await page.locator('[role=tab][tabindex="0"]').count(), 1, 'the tabs are one stop');

  await open_tab(page, 'design');
  const heading = page.locator('th button.sort').first();
  await heading.focus();
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('th').first().getAttribute('aria-sort'), 'ascending');
  await page.keyboard.press(' ');
  assert.equal(await page.locator('th').first().getAttribute('aria-sort'), 'descending');

  for (const tab of tabs) {
    await open_tab(page, tab);
    await page.evaluate(() => document.querySelectorAll('[data-visited]').forEach((one) => delete one.dataset.visited));
    const stops = await walk(page);
    const buttons = await page.locator('[role=tabpanel] button:visible').count();
    assert.ok(stops.length >= buttons, `${tab} has ${buttons} buttons, and the keyboard stops ${stops.length} times: ${stops.join(', ')}`);
  }
  expect_no_faults();
  await page.close();
});

test('nothing moves by itself for a reader who prefers less motion', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await open_tab(page, 'training');
  await page.waitForSelector('[data-figure=fitness] .plot svg');
  const plot = await page.locator('[data-figure=fitness] .plot').boundingBox();
  for (const share of [0.4, 0.6]) {
    await page.mouse.move(plot.x + share * plot.width, plot.y + 0.5 * plot.height);
  }
  assert.deepEqual(await page.evaluate(find_motion), []);

  await open_tab(page, 'motion');
  await page.waitForSelector('.replay-play');
  const before = await page.evaluate(() => window.armwright_replay.state.time_s);
  await draw_frames(page, 2);
  assert.equal(await page.evaluate(() => window.armwright_replay.state.time_s), before);
  assert.equal(await page.locator('.replay-play').innerText(), 'Play');
  assert.deepEqual(await page.evaluate(find_motion), []);
  expect_no_faults();
  await page.close();
});

test('keys scroll a cut table, and at its end the shadow is on the other side', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.setViewportSize({ width: 390, height: 844 });
  await settle(page);
  const box = page.getByRole('region', { name: 'Result' });
  const list_shadows = () =>
    box.evaluate((one) => Array.from(one.parentElement.querySelectorAll('.cut:not([hidden])'), (cut) => cut.className));
  assert.deepEqual(await list_shadows(), ['cut cut-right']);
  await box.focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => document.activeElement.scrollLeft > 2);
  await settle(page);
  assert.ok((await list_shadows()).includes('cut cut-left'));
  await box.evaluate((one) => (one.scrollLeft = one.scrollWidth));
  await settle(page);
  assert.deepEqual(await list_shadows(), ['cut cut-left']);
  expect_no_faults();
  await page.close();
});

test('the dialog with the numbers of a figure shows all of its parts on a narrow screen', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.setViewportSize({ width: 390, height: 844 });
  await open_tab(page, 'response');
  await page.locator('[data-figure=distance-response]').getByRole('button', { name: 'Table' }).click();
  await settle(page);
  const dialog = await page.locator('dialog').boundingBox();
  const hint = await page.locator('dialog .cut-hint').boundingBox();
  assert.ok(
    hint.y + hint.height <= dialog.y + dialog.height,
    `the sentence ends at ${hint.y + hint.height}, the dialog at ${dialog.y + dialog.height}`,
  );
  expect_no_faults();
  await page.close();
});
