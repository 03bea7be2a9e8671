// The data sheet as a printer gets it: one page of A4, without scripts, nothing cut off at its side. And on screens.
import assert from 'node:assert/strict';
import { readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { open_browser } from './browser.mjs';
import { find_layout_faults, find_violations } from './examine.mjs';
import { kFolder, run_program } from './make_pages.mjs';

let browser;
let folder; // with the data sheet of the run
before(async () => {
  browser = await open_browser();
  folder = export_datasheet('run');
});
after(() => browser.close());

// Writes the data sheet of the run and returns its folder.
function export_datasheet(run) {
  const out = join(kFolder, `datasheet-of-${run}`);
  rmSync(out, { recursive: true, force: true });
  run_program('export', join(kFolder, run), '--format', 'datasheet', '--out', out);
  return out;
}

async function open_datasheet(out) {
  const page = await browser.context.newPage();
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  const url = pathToFileURL(join(out, 'datasheet.html')).href;
  await page.goto(url);
  assert.deepEqual(requests, [url]);
  return page;
}

async function expect_one_page(out) {
  const page = await open_datasheet(out);
  assert.equal(await page.locator('script').count(), 0);
  const pdf = (await page.pdf({ preferCSSPageSize: true })).toString('latin1');
  assert.equal(pdf.match(/\/Type\s*\/Page\b/g).length, 1);
  // In points of 1/72 inch: 210 mm by 297 mm.
  const [, width, height] = pdf.match(/\/MediaBox\s*\[\s*0\s+0\s+([\d.]+)\s+([\d.]+)\s*\]/).map(Number);
  assert.ok(Math.abs(width - 595.3) < 1 && Math.abs(height - 841.9) < 1, `${width} x ${height}`);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  await page.close();
}

test('has the three errors, the whole workspace and speed, and the command that made it', async () => {
  const run = join(kFolder, 'run');
  const page = await open_datasheet(folder);
  await page.emulateMedia({ media: 'print' });
  const text = await page.locator('body').innerText();
  const { test_motion: motion } = JSON.parse(readFileSync(join(run, 'result.json'), 'utf8')).winner;
  const mm = (error_m) => String(Number((1000 * error_m).toPrecision(4)));
  assert.match(text, /Errors at rest, mm/);
  assert.ok(text.includes(`RMS ${mm(motion.error_while_moving_rms_m)} mm, peak ${mm(motion.error_while_moving_peak_m)} mm`), text);
  assert.ok(text.includes(`up to ${mm(motion.error_after_start_up_m)} mm before the target's first rest`), text);
  assert.match(text, /their integrals start empty, so gravity pulls the arm/);
  assert.match(text, /To make it: \S*armwright optimize q1-complex --optimizer ga --set task.ik_bug=true --budget 1400/);
  const cut = await page.$$eval('dd, p', (parts) =>
    parts
      .filter((part) => part.scrollHeight > part.clientHeight + 1 || part.scrollWidth > part.clientWidth + 1)
      .map((part) => part.textContent),
  );
  assert.deepEqual(cut, []);
  await page.close();
});

test('every number of its results is the recorded one, in the unit of its head', async () => {
  const { metrics, winner } = JSON.parse(readFileSync(join(kFolder, 'run', 'result.json'), 'utf8'));
  const errors = winner.test.case_errors.toSorted((a, b) => a - b);
  const metric = (name) => winner.test.metrics[metrics.indexOf(name)];
  const expected = {
    cases: errors.length,
    mean: (1000 * errors.reduce((sum, error) => sum + error, 0)) / errors.length,
    median: 500 * (errors[Math.floor((errors.length - 1) / 2)] + errors[Math.floor(errors.length / 2)]),
    worst: 1000 * errors.at(-1),
    'energy J': metric('energy'),
    'clamped %': 100 * metric('saturated_share'),
  };
  assert.ok(expected['clamped %'] > 0);
  const page = await open_datasheet(folder);
  const [heads, cells] = await page
    .locator('table', { has: page.getByText('Errors at rest, mm') })
    .locator('tr')
    .evaluateAll((rows) => rows.slice(0, 2).map((row) => Array.from(row.cells, (cell) => cell.textContent)));
  for (const [head, number] of Object.entries(expected)) {
    const shown = Number(cells[heads.indexOf(head)]);
    assert.ok(Math.abs(shown - number) <= 0.006 * number, `${head}: ${shown}, recorded ${number}`);
  }
  await page.close();
});

test('a PID fits on one page', () => expect_one_page(folder));

test('so does the controller with the most gains', async () => {
  const run = join(kFolder, 'neural');
  rmSync(run, { recursive: true, force: true });
  const flags = ['--optimizer', 'cmaes', '--engine', 'articulated', '--budget', '400', '--set', 'control.controller=neural'];
  const sets = ['--set', 'sets.validation_cases=1', '--set', 'sets.test_cases=2'];
  run_program('optimize', 'q1-complex', ...flags, ...sets, '--out', run, '--quiet');
  await expect_one_page(export_datasheet('neural'));
});

test('a data sheet fits every width in both themes, and axe-core finds nothing on it', async () => {
  const page = await open_datasheet(folder);
  const found = [];
  for (const width of [390, 768, 1280, 1920]) {
    await page.setViewportSize({ width, height: 844 });
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      const place = `${width} px, ${colorScheme}: `;
      found.push(...(await page.evaluate(find_layout_faults)).map((fault) => place + fault));
      if (width === 390 || width === 1280) {
        found.push(...(await find_violations(page)).map((fault) => place + fault));
      }
    }
    // A cell that is cut shows its text to the pointer.
    const cut = await page.$$eval('th, td, dd', (all) =>
      all
        .filter((one) => (one.scrollWidth > one.clientWidth || one.scrollHeight > one.clientHeight + 1) && one.title === '')
        .map((one) => one.textContent),
    );
    found.push(...cut.map((text) => `${width} px: "${text}" is cut`));
  }
  await page.close();
  assert.deepEqual(found, []);
});
