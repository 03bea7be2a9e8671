import assert from 'node:assert/strict';
import { readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { find_figure, list_points, list_tabs, open_browser, open_page, open_tab } from './browser.mjs';
import { kFolder, run_program } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

const open_study = () => open_page(browser, join(kFolder, 'study.html'));

async function open_tab_of(page, figure) {
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    if ((await page.locator(`[data-figure^="${figure}"]`).count()) > 0) {
      return page.locator(`[data-figure^="${figure}"]`).first();
    }
  }
  return assert.fail(`no tab has ${figure}`);
}

test('the headline and the whole grid are on the first screen', async () => {
  const { page, expect_no_faults } = await open_study();
  await page.setViewportSize({ width: 1280, height: 800 });
  const cards = await page.$$eval('main .card', (all) => all.map((card) => card.dataset.figure));
  assert.deepEqual(cards.slice(0, 3), ['headline', 'standing', 'verdict']);
  // Six replicates cannot decide between four optimizers.
  const headline = await page.locator('[data-figure=headline] p').allInnerTexts();
  assert.deepEqual(headline, [
    'No pair of optimizers can be decided on any of the 2 problems with 6 replicates; at least 9 are needed.',
    'No optimizer failed, and every run has a value on the test set.',
  ]);
  const plot = page.locator('[data-figure=standing] .plot');
  await plot.locator('svg').waitFor();
  const box = await plot.boundingBox();
  assert.ok(box.y + box.height < 800, `the grid ends at ${box.y + box.height}`);
  const texts = await plot.locator('svg text').allTextContents();
  for (const text of ['cmaes', 'ga', 'nlopt:bobyqa', 'random', 'q1-complex', 'q2-e6', 'no verdict']) {
    assert.ok(texts.includes(text), `${text} is not among ${texts.join(', ')}`);
  }
  expect_no_faults();
  await page.close();
});

test('the verdict is folded away, and opened it is word for word as in its file', async () => {
  const { page, expect_no_faults } = await open_study();
  const folded = page.locator('[data-figure=verdict] details');
  assert.equal(await folded.locator('p').first().isVisible(), false);
  await folded.locator('summary').click();
  const shown = await folded.locator('p').allInnerTexts();
  const verdict = readFileSync(join(kFolder, 'study/verdict.txt'), 'utf8');
  assert.equal(shown.join(' ').replace(/\s+/g, ' ').trim(), verdict.replace(/\s+/g, ' ').trim());
  expect_no_faults();
  await page.close();
});

test('one filter applies to all tabs, and survives a change of the tab', async () => {
  const { page, expect_no_faults } = await open_study();
  const filter = page.locator('.filter');
  assert.equal(await filter.locator('summary').innerText(), '5 of 5 optimizers are shown.');
  assert.equal(await filter.locator('input').first().isVisible(), false);
  await filter.locator('summary').click();
  assert.equal(await filter.getByText('only the best 12').isVisible(), false); // there are five
  await filter.getByRole('searchbox').fill('cma nlopt:*');
  const expect_shown = async (sentence, present, absent) => {
    assert.equal(await filter.locator('summary').innerText(), sentence);
    const texts = page.locator('main svg text');
    await page.waitForFunction(
      (name) => Array.from(document.querySelectorAll('main svg text')).some((text) => text.textContent === name),
      present,
    );
    await page.waitForFunction(
      (name) => Array.from(document.querySelectorAll('main svg text')).every((text) => text.textContent !== name),
      absent,
    );
    assert.ok((await texts.count()) > 0);
    const cells = await page.locator('main td').allInnerTexts();
    assert.ok(cells.includes(present) && !cells.includes(absent), cells.slice(0, 20).join(', '));
  };
  const sentence = '2 of 5 optimizers are shown.';
  await expect_shown(sentence, 'nlopt:bobyqa', 'ga');
  await open_tab(page, 'problem-q2-e6');
  await expect_shown(sentence, 'nlopt:bobyqa', 'ga');
  assert.equal(await filter.getByRole('searchbox').inputValue(), 'cma nlopt:*');
  // A family less, and all names again.
  await filter.getByRole('searchbox').fill('');
  await filter.getByRole('checkbox', { name: 'nlopt (1)' }).click();
  await expect_shown('4 of 5 optimizers are shown.', 'ga', 'nlopt:bobyqa');
  await filter.getByRole('searchbox').fill('zzz');
  assert.equal(await filter.locator('summary').innerText(), '5 of 5 optimizers are shown, because no name matches.');
  expect_no_faults();
  await page.close();
});

test('a term is explained to the pointer, the keyboard and a finger', async () => {
  const { page, expect_no_faults } = await open_study();
  await open_tab(page, 'problem-q1-complex');
  const caption = page.locator('[data-figure=pairs-table-q1-complex] .caption');
  const term = caption.locator('.term', { hasText: 'A12' });
  const meaning = page.getByRole('tooltip');
  await page.mouse.move(2, 2); // on nothing, wherever the page is scrolled to
  await term.scrollIntoViewIfNeeded();
  assert.equal(await meaning.count(), 0);
  await term.hover();
  assert.match(await meaning.innerText(), /^A12 The probability that a run of one optimizer is better/);
  const [at, on] = [await meaning.boundingBox(), await term.boundingBox()];
  assert.ok(at.y >= on.y + on.height || at.y + at.height <= on.y, 'the meaning covers its term');
  // The pointer may go to the meaning, and back to where nothing is explained.
  await meaning.hover();
  assert.equal(await meaning.count(), 1);
  await page.mouse.move(2, 2);
  await meaning.waitFor({ state: 'hidden' });

  await term.focus();
  assert.match(await meaning.innerText(), /^A12 /);
  assert.equal(await term.getAttribute('aria-describedby'), await meaning.getAttribute('id'));
  await page.keyboard.press('Escape');
  assert.equal(await meaning.count(), 0);
  await page.keyboard.press('Shift+Tab');
  assert.match(await meaning.innerText(), /^Holm's correction /);
  await page.keyboard.press('Escape');

  await term.dispatchEvent('click'); // a finger on a system that gives buttons no focus
  assert.match(await meaning.innerText(), /^A12 /);
  await page.locator('h1').click();
  assert.equal(await meaning.count(), 0);
  expect_no_faults();
  await page.close();
});

test('headings explain their terms and still sort', async () => {
  const { page, expect_no_faults } = await open_study();
  await open_tab(page, 'problem-q1-complex');
  const table = page.locator('[data-figure=ranking-q1-complex]');
  const heading = table.locator('th').getByRole('button', { name: 'mean rank' });
  await heading.click();
  assert.match(await page.getByRole('tooltip').innerText(), /^rank of an optimizer Its place among the optimizers/);
  assert.equal(await table.locator('th[aria-sort=ascending]').innerText(), await heading.innerText());
  await page.keyboard.press('Escape');
  await page.locator('[data-figure=convergence-q1-complex]').getByRole('button', { name: 'Table' }).click();
  await page.locator('dialog').getByRole('button', { name: 'lower quartile' }).focus();
  assert.match(await page.getByRole('tooltip').innerText(), /^quartiles /);
  await page.keyboard.press('Escape');
  assert.equal(await page.getByRole('tooltip').count(), 0);
  assert.equal(await page.locator('dialog').count(), 1, 'the first Escape only hides the meaning');
  await page.keyboard.press('Escape');
  await page.locator('dialog').waitFor({ state: 'detached' });
  expect_no_faults();
  await page.close();
});

test('each design has one name on all pages', () => {
  for (const name of ['run', 'front', 'study', 'reproduction']) {
    const data = JSON.parse(readFileSync(join(kFolder, `${name}.html`), 'utf8').match(/id="data">([^]*?)<\/script>/)[1]);
    const names = new Set([
      ...data.replays.flatMap((set) => set.designs.map((design) => design.name)),
      ...(data.arm?.designs ?? []).map((design) => design.name),
      ...(data.arm?.response.series ?? []).map((series) => series.name),
      ...(data.arm?.sweep?.series ?? data.sweep?.series ?? []).map((series) => series.name),
      ...(data.test?.designs ?? []).map((design) => design.name),
    ]);
    const own = (data.optimizers ?? []).map((one) => one.label);
    const usual = (one) => ['winner', 'base controllers', 'published'].includes(one) || own.some((label) => one.startsWith(label));
    const wrong = [...names].filter((one) => !(name === 'reproduction' ? /^(A\.([5-9]|1[01])|base controllers)$/.test(one) : usual(one)));
    assert.deepEqual(wrong, [], `names of designs on the page ${name}`);
    assert.ok(names.has('base controllers'), `${name}: ${[...names].join(', ')}`);
  }
});

test('a printed page shows the folded verdict', async () => {
  const { page, expect_no_faults } = await open_study();
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  assert.equal(await page.locator('[data-figure=verdict] p').first().isVisible(), true);
  await page.evaluate(() => window.dispatchEvent(new Event('afterprint')));
  assert.equal(await page.locator('[data-figure=verdict] p').first().isVisible(), false);
  expect_no_faults();
  await page.close();
});

test('a cell shows the command that reproduces it, and it does', async () => {
  const { page, expect_no_faults } = await open_study();
  const card = await open_tab_of(page, 'cells');
  await card.locator('tbody .link').first().click();
  const command = await card.locator('.command code').innerText();
  assert.match(command, /^\S*armwright rerun /);
  const cell = command.match(/cells?\/(\S+)|rerun \S+ (\S+)/)?.[2];
  rmSync(join(kFolder, 'rerun'), { recursive: true, force: true });
  const said = run_program('rerun', join(kFolder, 'study'), cell.replace(/^'|'$/g, ''), '--out', join(kFolder, 'rerun'), '--quiet');
  assert.match(said, /identical/);
  expect_no_faults();
  await page.close();
});

test('a point of the box plots names its run', async () => {
  const { page, expect_no_faults } = await open_study();
  const card = await open_tab_of(page, 'values');
  const id = await card.getAttribute('data-figure');
  await find_figure(page, id);
  await page.waitForFunction((name) => document.querySelectorAll(`[data-figure="${name}"] .plot svg path`).length > 5, id);
  let said = '';
  for (const [x, y] of await list_points(card)) {
    await page.mouse.move(x, y);
    const pointed = await card.locator('.plot').evaluate((plot) => plot.querySelector('.tip')?.textContent ?? '');
    if (pointed.includes('reproduces')) {
      await page.mouse.click(x, y);
      said = await card.locator('.details').innerText();
      break;
    }
  }
  assert.match(said, /armwright rerun /);
  expect_no_faults();
  await page.close();
});
