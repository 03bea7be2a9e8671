// The pages for readers who use the keyboard, a screen reader or few colours. axe-core finds nothing on any tab of any
// page, on a screen in one theme and on a telephone in the other. Each chart has a sentence about what it shows.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { build_site } from '../../web/site/build.mjs';
import { list_tabs, open_browser, open_page, open_tab } from './browser.mjs';
import { kFolder } from './make_pages.mjs';
import { kReports, make_datasheet, start_watch } from './pages.mjs';

const kAxe = readFileSync(createRequire(new URL('../../web/package.json', import.meta.url)).resolve('axe-core/axe.min.js'), 'utf8');
const kRoot = new URL('../..', import.meta.url).pathname;
const kSizes = [
  { width: 1280, height: 900 },
  { width: 390, height: 844 },
];

let browser;
const site = mkdtempSync(join(tmpdir(), 'armwright-site-'));
before(async () => {
  await build_site(kRoot, site);
  browser = await open_browser({ reducedMotion: 'reduce' });
});
after(async () => {
  await browser.close();
  rmSync(site, { recursive: true, force: true });
});

// Runs axe-core in the page, on what is now on the screen, and returns its violations. Before, the function takes out
// what cannot add a finding, and puts it back after. This is the drawing of a chart: axe-core has no rule for its
// parts, and it cannot tell the ground of a text in an SVG. It is also each row of a table that repeats an earlier one:
// the same elements with the same attributes and computed colours, and texts in the same places.
async function run_axe(options) {
  const undo = [];
  const put = (one, other) => {
    one.replaceWith(other);
    undo.push(() => other.replaceWith(one));
  };
  document.querySelectorAll('.plot svg').forEach((svg) => put(svg, document.createComment('svg')));

  const describe = (element) => {
    const { color, backgroundColor, backgroundImage, fontSize, fontWeight, opacity, visibility, display } = getComputedStyle(element);
    const attributes = Array.from(element.attributes, ({ name, value }) => `${name}=${name === 'title' ? value.trim() !== '' : value}`);
    const texts = Array.from(element.childNodes, (node) =>
      node.nodeType === Node.ELEMENT_NODE ? describe(node) : node.textContent.trim().slice(0, 2).length,
    );
    return [
      element.tagName,
      attributes,
      color,
      backgroundColor,
      backgroundImage,
      fontSize,
      fontWeight,
      opacity,
      visibility,
      display,
      texts,
    ];
  };
  for (const body of document.querySelectorAll('tbody')) {
    const known = new Set();
    const repeated = Array.from(body.rows).filter((row) => {
      const description = JSON.stringify(describe(row));
      return known.size === known.add(description).size;
    });
    if (repeated.length > 0) {
      // The box of the table is cut as before.
      const table = body.closest('table');
      const { minWidth } = table.style;
      const heights = repeated.map((row) => row.offsetHeight);
      table.style.minWidth = `${table.offsetWidth}px`;
      undo.push(() => (table.style.minWidth = minWidth));
      repeated.forEach((row, i) => {
        const gap = document.createElement('tr');
        gap.style.height = `${heights[i]}px`;
        put(row, gap);
      });
    }
  }

  const { violations } = await globalThis.axe.run(document, { resultTypes: ['violations'], ...options });
  undo.reverse().forEach((step) => step());
  return violations.map(({ impact, id, help, nodes }) => ({ impact, id, help, nodes: nodes.slice(0, 1), count: nodes.length }));
}

// Returns one sentence per violation that axe-core finds in what is now on the screen. Playwright evaluates its
// source, so that the pages' content security policy stays as it is. Axe-core names the places of its findings in a
// second run, because it would name the place of each element that it looks at.
async function find_violations(page, place) {
  if (!(await page.evaluate(() => 'axe' in globalThis))) {
    await page.evaluate(kAxe);
  }
  const found = await page.evaluate(run_axe, { selectors: false });
  const named = found.length === 0 ? [] : await page.evaluate(run_axe, {});
  return (named.length < found.length ? found : named).map(({ impact, id, help, nodes: [{ target, html, any }], count }) => {
    return `${place}: ${impact}: ${id}: ${help}; ${count} of ${target?.join(' ')}: ${html.slice(0, 160)} ${any[0]?.message ?? ''}`;
  });
}

// Returns one sentence per chart that says its title alone, or nothing of what it shows.
async function find_silent_charts(page, place) {
  const charts = await page.$$eval('.card .plot', (plots) =>
    plots.map((plot) => {
      const card = plot.closest('.card');
      return {
        id: card.dataset.figure,
        title: card.querySelector('h3').textContent,
        role: plot.getAttribute('role'),
        label: plot.ariaLabel ?? '',
      };
    }),
  );
  return charts
    .filter(({ title, role, label }) => {
      const seen = label.slice(title.length + 2);
      return role !== 'img' || !label.startsWith(title + '. ') || seen.split(' ').length < 6 || !/\d/.test(seen);
    })
    .map(({ id, label }) => `${place}: the chart ${id} says "${label}"`);
}

// Opens every tab on a screen in one theme and on a telephone in the other; every second page has the themes the other
// way round. On the screen, each tab also has the dialog of its first figure open.
async function find_faults_of_report(address, name) {
  const { page, expect_no_faults } = await open_page(browser, address);
  const found = [];
  if (kReports.indexOf(name) % 2 === 1) {
    await page.click('.theme');
  }
  for (const size of kSizes) {
    await page.setViewportSize(size);
    const theme = await page.evaluate(() => document.documentElement.dataset.theme);
    for (const tab of await list_tabs(page)) {
      await open_tab(page, tab);
      await page.waitForFunction(() => Array.from(document.querySelectorAll('.plot')).every((plot) => plot.querySelector('svg') !== null));
      const place = `${name}, ${tab}, ${size.width} px, ${theme}`;
      found.push(...(await find_violations(page, place)), ...(await find_silent_charts(page, place)));
      const tables = page.locator('figure .buttons button:has-text("Table")');
      if (size === kSizes[0] && (await tables.count()) > 0) {
        await tables.first().click();
        found.push(...(await find_violations(page, `${place}, dialog`)));
        await page.click('.close-dialog');
      }
    }
    await page.click('.theme');
  }
  expect_no_faults();
  await page.close();
  return found;
}

for (const name of kReports) {
  test(`axe-core finds nothing on the page of the ${name}`, async () => {
    assert.deepEqual(await find_faults_of_report(join(kFolder, `${name}.html`), name), []);
  });
}

test('axe-core finds nothing on the page of a study under way', async () => {
  const { address, stop } = await start_watch('watched-for-access');
  const found = await find_faults_of_report(address, 'watch');
  await stop();
  assert.deepEqual(found, []);
});

// Opens the file on a screen in one of the `themes` and on a telephone in the other.
async function find_violations_of_text(file, name, themes, prepare = async () => {}) {
  const page = await browser.context.newPage();
  const found = [];
  for (const [i, size] of kSizes.entries()) {
    const colorScheme = themes[i];
    await page.setViewportSize(size);
    await page.emulateMedia({ colorScheme });
    await page.goto(pathToFileURL(file).href);
    await prepare(page);
    found.push(...(await find_violations(page, `${name}, ${size.width} px, ${colorScheme}`)));
  }
  await page.close();
  return found;
}

const kThemes = ['light', 'dark'];
const kOtherThemes = ['dark', 'light'];

test('axe-core finds nothing on a data sheet', async () => {
  const file = make_datasheet('datasheet-for-access');
  assert.deepEqual(await find_violations_of_text(file, 'data sheet', kThemes), []);
  assert.deepEqual(await find_violations_of_text(file, 'data sheet', kOtherThemes), []);
});

// The first page, tables, sessions, code of several languages, pictures, long tables. Every second page has the themes
// the other way round.
for (const [i, place] of [
  'index.html',
  'tutorials/tune.html',
  'tutorials/add-an-optimizer.html',
  'report.html',
  'reliability.html',
  'reference/configuration.html',
  'optimizers/index.html',
  'optimizers/cmaes.html',
  'changelog.html',
].entries()) {
  test(`axe-core finds nothing on the site's page ${place}`, async () => {
    assert.deepEqual(await find_violations_of_text(join(site, place), place, i % 2 === 0 ? kThemes : kOtherThemes), []);
  });
}

test('axe-core finds nothing while the search is open', async () => {
  const search = async (page) => {
    await page.fill('#search', 'tune a robot');
    await page.waitForSelector('#found a');
  };
  for (const themes of [kThemes, kOtherThemes]) {
    assert.deepEqual(await find_violations_of_text(join(site, 'verify.html'), 'search', themes, search), []);
  }
});

// Presses Tab until the focus leaves the page or comes around. Returns what had the focus, and complains about each
// element that does not show it.
async function walk(page) {
  const stops = [];
  for (let i = 0; i < 400; ++i) {
    await page.keyboard.press('Tab');
    const stop = await page.evaluate(() => {
      const element = document.activeElement;
      if (element === document.body || element.dataset.visited) {
        return null;
      }
      element.dataset.visited = 'yes';
      const { outlineStyle, outlineWidth } = getComputedStyle(element);
      const { width, height, right } = element.getBoundingClientRect();
      return {
        name: `${element.tagName.toLowerCase()} ${element.id || element.className} "${(element.ariaLabel ?? element.textContent).trim().slice(0, 40)}"`,
        is_shown: outlineStyle !== 'none' && parseFloat(outlineWidth) >= 1 && width > 0 && height > 0 && right > 0,
      };
    });
    if (stop === null) {
      break;
    }
    stops.push(stop);
  }
  assert.deepEqual(
    stops.filter(({ is_shown }) => !is_shown).map(({ name }) => name),
    [],
    'the focus is not visible',
  );
  return stops.map(({ name }) => name);
}

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

test('the keyboard alone in the site', async () => {
  const page = await browser.context.newPage();
  await page.goto(pathToFileURL(join(site, 'tutorials/add-an-optimizer.html')).href);
  const stops = await walk(page);
  assert.match(stops[0], /"To the text"/);
  assert.ok(
    stops.some((name) => name.startsWith('pre')),
    'a box of code is cut, and the keyboard does not reach it',
  );
  await page.close();
});

// Returns the elements that move or scroll by themselves.
function find_motion() {
  const is_still = (element, pseudo) => {
    const style = getComputedStyle(element, pseudo);
    const moves = style.animationName !== 'none' || style.transitionDuration.split(', ').some((time) => time !== '0s');
    return !moves && style.scrollBehavior === 'auto';
  };
  const found = Array.from(document.querySelectorAll('*')).filter(
    (one) => ![null, '::before', '::after'].every((part) => is_still(one, part)),
  );
  return found
    .map((one) => `${one.tagName} ${one.getAttribute('class')} ${one.getAttribute('style')}`)
    .concat(document.getAnimations().map(String));
}

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
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  assert.equal(await page.evaluate(() => window.armwright_replay.state.time_s), before);
  assert.equal(await page.locator('.replay-play').innerText(), 'Play');
  assert.deepEqual(await page.evaluate(find_motion), []);
  expect_no_faults();

  await page.goto(pathToFileURL(join(site, 'report.html')).href);
  assert.deepEqual(await page.evaluate(find_motion), []);
  await page.close();
});
