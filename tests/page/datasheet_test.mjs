// The datasheet as a printer gets it: one page of A4, without scripts, nothing cut off at its side.
import assert from 'node:assert/strict';
import { readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { open_browser } from './browser.mjs';
import { kFolder, run_program } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

async function open_datasheet(run) {
  const out = join(kFolder, 'datasheet');
  rmSync(out, { recursive: true, force: true });
  run_program('export', run, '--format', 'datasheet', '--out', out);
  const page = await browser.context.newPage();
  return { page, out };
}

async function expect_one_page(run) {
  const { page, out } = await open_datasheet(run);
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  const url = pathToFileURL(join(out, 'datasheet.html')).href;
  await page.goto(url);
  assert.deepEqual(requests, [url]);
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
  const { page, out } = await open_datasheet(run);
  await page.goto(pathToFileURL(join(out, 'datasheet.html')).href);
  await page.emulateMedia({ media: 'print' });
  const text = await page.locator('body').innerText();
  const { test_motion: motion } = JSON.parse(readFileSync(join(run, 'result.json'), 'utf8')).winner;
  const mm = (error_m) => String(Number((1000 * error_m).toPrecision(4)));
  assert.match(text, /Errors at rest, mm/);
  assert.ok(text.includes(`RMS ${mm(motion.error_while_moving_rms_m)} mm, peak ${mm(motion.error_while_moving_peak_m)} mm`), text);
  assert.ok(text.includes(`up to ${mm(motion.error_after_start_up_m)} mm before the target's first rest`), text);
  assert.match(text, /their integrals start empty, so gravity pulls the arm/);
  assert.match(text, /To make it: \S*armwright optimize q1-complex --engine articulated --budget 1400/);
  const cut = await page.$$eval('dd, p', (parts) =>
    parts
      .filter((part) => part.scrollHeight > part.clientHeight + 1 || part.scrollWidth > part.clientWidth + 1)
      .map((part) => part.textContent),
  );
  assert.deepEqual(cut, []);
  await page.close();
});

test('a PID fits on one page', () => expect_one_page(join(kFolder, 'run')));

test('so does the controller with the most gains', async () => {
  const run = join(kFolder, 'neural');
  rmSync(run, { recursive: true, force: true });
  const flags = ['--optimizer', 'cmaes', '--engine', 'articulated', '--budget', '60', '--set', 'control.controller=neural'];
  const sets = ['--set', 'sets.validation_cases=1', '--set', 'sets.test_cases=2'];
  run_program('optimize', 'q1-complex', ...flags, ...sets, '--out', run, '--quiet');
  await expect_one_page(run);
});
