// The documentation's site as a reader has it: from disk, in Chromium, with nothing asked of the network.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { build_site } from '../../web/site/build.mjs';
import { open_browser } from './browser.mjs';
import { find_motion, find_violations, walk } from './examine.mjs';

const kRoot = new URL('../..', import.meta.url).pathname;
const kPhone = { width: 360, height: 740 };
const kDesktop = { width: 1280, height: 900 };
const folder = mkdtempSync(join(tmpdir(), 'armwright-site-'));
const faults = [];
let browser;
let page;
let served = ''; // the address of serve_site(), while it serves

function address(place) {
  return pathToFileURL(join(folder, place)).href;
}

before(async () => {
  await build_site(kRoot, folder);
  browser = await open_browser();
  page = await browser.context.newPage();
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && faults.push(message.text()));
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('request', (request) => {
    const url = request.url();
    if (!/^(file|data):/.test(url) && (served === '' || !url.startsWith(served))) {
      faults.push(`network: ${url}`);
    }
  });
});
after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
});

// Serves the site on this machine for what pages store: of pages from disk, Chromium sometimes loses it on a
// busy machine. Returns the function that ends it.
async function serve_site() {
  const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
  const server = createServer((request, response) => {
    const place = decodeURIComponent(new URL(request.url, served).pathname);
    try {
      const content = readFileSync(join(folder, place));
      response.setHeader('Content-Type', types[extname(place)] ?? 'application/octet-stream');
      response.end(content);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  server.unref(); // a failed test does not wait for it
  served = `http://127.0.0.1:${server.address().port}/`;
  return () => {
    served = '';
    server.close();
    server.closeAllConnections();
  };
}

async function expect_fits(place) {
  const [wide, window_width] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(wide <= window_width, `${place}: ${wide} px wide in a window of ${window_width}`);
}

test('from the first page through the tutorials to the next page', async () => {
  await page.goto(address('index.html'));
  assert.ok(await page.locator('article img').evaluate((image) => image.complete && image.naturalWidth > 300));
  await page.click('article a:has-text("Tune an arm")');
  assert.match(await page.locator('h1').textContent(), /^Tune an arm in five minutes/);
  assert.equal(await page.locator('#pages [aria-current]').textContent(), 'Tune an arm');
  await page.click('.neighbours .after');
  assert.match(await page.title(), /^Compare optimizers/);
  await page.click('aside a:has-text("Add optimizers and replicates")');
  assert.match(page.url(), /compare\.html#5-add-optimizers-and-replicates/);
  assert.deepEqual(faults, []);
});

test('the search finds a part of a page and goes there, with the keyboard alone', async () => {
  await page.goto(address('tutorials/tune.html'));
  await page.keyboard.press('/');
  await page.keyboard.type('coevolution');
  await page.waitForSelector('#found a');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await page.waitForURL(/(racing|architecture|engines|findings|comparing|glossary)\.html|changelog\.html/);
  assert.match(await page.locator('article').textContent(), /coevolution/i);
  await page.fill('#search', 'zzzzqqqq');
  await page.waitForSelector('#found p');
  assert.match(await page.locator('#found').textContent(), /Nothing about "zzzzqqqq"/);
  await page.keyboard.press('Escape');
  assert.ok(await page.locator('#found').isHidden());
  assert.deepEqual(faults, []);
});

// A click, a change of the system's theme and what another page has stored arrive when the browser gets to them: the colour is
// awaited, and the message says which one the page kept instead.
async function expect_ground(place, expected, tab = page) {
  const read = () => tab.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await tab
    .waitForFunction((colour) => getComputedStyle(document.body).backgroundColor === colour, expected)
    .catch(async () => assert.equal(await read(), expected, place));
}

test('light and dark: the system decides, then the reader', async () => {
  const stop_serving = await serve_site();
  const white = 'rgb(255, 255, 255)';
  const dark = 'rgb(18, 22, 27)';
  await page.goto(served + 'index.html');
  await expect_ground('the system is light', white);
  await page.emulateMedia({ colorScheme: 'dark' });
  await expect_ground('the system is dark', dark);
  await page.click('#theme');
  await expect_ground('the reader prefers light', white);
  await page.emulateMedia({ colorScheme: 'light' });
  await page.click('#theme');
  await expect_ground('the reader prefers dark', dark);
  await page.goto(served + 'verify.html');
  await expect_ground('the choice holds on the next page', dark);
  const other = await browser.context.newPage();
  await other.goto(served + 'index.html');
  await expect_ground('the choice holds in another tab', dark, other);
  await other.click('#theme');
  await expect_ground('the choice made in another tab holds here too', white);
  await other.close();
  await page.goto(address('index.html'));
  stop_serving();
  assert.deepEqual(faults, []);
});

test('what is copied of a session is what is typed', async () => {
  await browser.context.grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.goto(address('tutorials/tune.html'));
  await page.locator('figure.console').first().hover();
  await page.locator('.copy').first().click();
  await page.waitForSelector('.copy:has-text("Copied")');
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), 'armwright list problems irb4600\n');
  assert.deepEqual(faults, []);
});

test('on a phone nothing has to be scrolled sideways, and the menu opens', async () => {
  await page.setViewportSize(kPhone);
  // Long tables, long lines, long words.
  for (const place of [
    'index.html',
    'tutorials/add-an-optimizer.html',
    'reliability.html',
    'findings.html',
    'plugin-protocol.html',
    'exporting.html',
    'readme.html',
    'optimizers/index.html',
  ]) {
    await page.goto(address(place));
    await expect_fits(place);
  }
  assert.ok(await page.locator('#pages').isHidden());
  await page.click('#menu');
  await page.click('#pages a:has-text("Compare optimizers")');
  assert.match(page.url(), /tutorials\/compare\.html$/);
  await page.setViewportSize(kDesktop);
  assert.deepEqual(faults, []);
});

test('long names in a table break at their joints and leave room for the other columns', async () => {
  for (const width of [390, 1280]) {
    await page.setViewportSize({ width, height: 844 });
    await page.goto(address('reliability.html'));
    const { columns, box, cut, over } = await page
      .locator('.table:has(th:text-is("promise"))')
      .first()
      .evaluate((one) => ({
        columns: Array.from(one.querySelectorAll('th'), (cell) => cell.getBoundingClientRect().width),
        box: one.clientWidth,
        cut: one.scrollWidth - one.clientWidth,
        over: Array.from(one.querySelectorAll('td code'))
          .filter((code) => code.getBoundingClientRect().right > code.closest('td').getBoundingClientRect().right + 1)
          .map((code) => code.textContent),
      }));
    assert.ok(cut <= 1, `at ${width} px the table of faults is ${cut} px wider than its box`);
    assert.deepEqual(over, [], `names leave their cells at ${width} px`);
    const promise = columns[1] / box;
    assert.ok(promise > 0.3, `at ${width} px the promises have ${(100 * promise).toFixed(0)} % of the width: ${columns}`);
  }
  await page.setViewportSize(kDesktop);
  assert.deepEqual(faults, []);
});

test('on paper there is the text alone, dark on white whatever the theme', async () => {
  await page.goto(address('verify.html'));
  await page.evaluate(() => (document.documentElement.dataset.theme = 'dark'));
  await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
  const code = page.locator('figure.console, pre').first();
  assert.equal(await code.evaluate((element) => getComputedStyle(element).getPropertyValue('color-scheme')), 'light');
  for (const part of ['header', '#pages', 'aside', '.neighbours']) {
    assert.ok(await page.locator(part).first().isHidden(), part);
  }
  assert.ok(await page.locator('article').isVisible());
  await page.emulateMedia({ media: 'screen', colorScheme: 'light' });
  assert.deepEqual(faults, []);
});

// The first page, tables, sessions, code of several languages, pictures, long tables, and the search: some on a screen,
// some on a telephone, some in either theme.
const kSizes = [kDesktop, { width: 390, height: 844 }];
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
  'verify.html',
].entries()) {
  test(`axe-core finds nothing on the site's page ${place}`, async () => {
    await page.setViewportSize(kSizes[i % 2]);
    await page.emulateMedia({ colorScheme: i % 4 < 2 ? 'light' : 'dark', reducedMotion: 'reduce' });
    await page.goto(address(place));
    assert.deepEqual(await find_violations(page), []);
  });
}

test('axe-core finds nothing while the search is open', async () => {
  await page.setViewportSize(kDesktop);
  for (const colorScheme of ['dark', 'light']) {
    await page.emulateMedia({ colorScheme });
    await page.goto(address('tutorials/compare.html'));
    await page.fill('#search', 'tune a robot');
    await page.waitForSelector('#found a');
    assert.deepEqual(await find_violations(page), []);
    await page.setViewportSize(kSizes[1]);
  }
});

test('the keyboard alone in the site', async () => {
  await page.goto(address('tutorials/add-an-optimizer.html'));
  const stops = await walk(page);
  assert.match(stops[0], /"To the text"/);
  assert.ok(
    stops.some((name) => name.startsWith('pre')),
    'a box of code is cut, and the keyboard does not reach it',
  );
});

test('nothing in the site moves by itself for a reader who prefers less motion', async () => {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  await page.goto(address('report.html'));
  assert.deepEqual(await page.evaluate(find_motion), []);
});
