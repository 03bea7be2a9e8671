// The pages for readers who use the keyboard, a screen reader or few colours. axe-core finds nothing on any tab of any
// page, in both themes, on a screen and on a telephone. Each chart has a sentence about what it shows.
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
  browser = await open_browser();
});
after(async () => {
  await browser.close();
  rmSync(site, { recursive: true, force: true });
});

// Returns one sentence per violation that axe-core finds in what is now on the screen. Playwright evaluates its
// source, so that the pages' content security policy stays as it is.
async function find_violations(page, place) {
  if (!(await page.evaluate(() => 'axe' in globalThis))) {
    await page.evaluate(kAxe);
  }
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return violations.map(({ impact, id, help, nodes }) => {
    const { target, html, any } = nodes[0];
    return `${place}: ${impact}: ${id}: ${help}; ${nodes.length} of ${target.join(' ')}: ${html.slice(0, 160)} ${any[0]?.message ?? ''}`;
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

// Opens every tab at every size and in both themes. In the second theme, each tab also has the dialog of its first
// figure open.
async function find_faults_of_report(address, name) {
  const { page, expect_no_faults } = await open_page(browser, address);
  const found = [];
  for (const size of kSizes) {
    await page.setViewportSize(size);
    for (let round = 0; round < 2; ++round) {
      const theme = await page.evaluate(() => document.documentElement.dataset.theme);
      for (const tab of await list_tabs(page)) {
        await open_tab(page, tab);
        await page.waitForFunction(() =>
          Array.from(document.querySelectorAll('.plot')).every((plot) => plot.querySelector('svg') !== null),
        );
        const place = `${name}, ${tab}, ${size.width} px, ${theme}`;
        found.push(...(await find_violations(page, place)), ...(await find_silent_charts(page, place)));
        const tables = page.locator('figure .buttons button:has-text("Table")');
        if (size === kSizes[0] && (await tables.count()) > 0) {
          await tables.first().click();
          found.push(...(await find_violations(page, `${place}, dialog`)));
          await page.keyboard.press('Escape');
        }
      }
      await page.click('.theme');
    }
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

async function find_violations_of_text(file, name, prepare = async () => {}) {
  const page = await browser.context.newPage();
  const found = [];
  for (const size of kSizes) {
    await page.setViewportSize(size);
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      await page.goto(pathToFileURL(file).href);
      await prepare(page);
      found.push(...(await find_violations(page, `${name}, ${size.width} px, ${colorScheme}`)));
    }
  }
  await page.close();
  return found;
}

test('axe-core finds nothing on a data sheet', async () => {
  assert.deepEqual(await find_violations_of_text(make_datasheet('datasheet-for-access'), 'data sheet'), []);
});

// The first page, tables, sessions, code of several languages, pictures, long tables.
for (const place of [
  'index.html',
  'tutorials/tune.html',
  'tutorials/add-an-optimizer.html',
  'report.html',
  'reliability.html',
  'reference/configuration.html',
  'optimizers/index.html',
  'optimizers/cmaes.html',
  'changelog.html',
]) {
  test(`axe-core finds nothing on the site's page ${place}`, async () => {
    assert.deepEqual(await find_violations_of_text(join(site, place), place), []);
  });
}

test('axe-core finds nothing while the search is open', async () => {
  const search = async (page) => {
    await page.fill('#search', 'tune a robot');
    await page.waitForSelector('#found a');
  };
  assert.deepEqual(await find_violations_of_text(join(site, 'verify.html'), 'search', search), []);
});
