import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { draw_frames, open_browser, open_page } from './browser.mjs';
import { kFolder } from './make_pages.mjs';
import { start_watch } from './pages.mjs';

let browser;
let served;
let address;
const kCell = 'cells/q2-e6/ga/r06';
const study = join(kFolder, 'watched');

// Starts the program and returns it with the address that it prints.
async function watch(folder) {
  const server = spawn(process.env.ARMWRIGHT, ['watch', folder], {
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const said = await new Promise((resolve, reject) => {
    server.stdout.once('data', (data) => resolve(String(data)));
    server.once('exit', (code) => reject(new Error(`watch ended with ${code}`)));
  });
  return { server, address: said.match(/http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\//)[0] };
}

// Sends the signal and returns the exit code.
function end(child, signal) {
  child.removeAllListeners('exit');
  const ended = new Promise((resolve) => child.once('exit', resolve));
  child.kill(signal);
  return ended;
}

// A study that lacks a cell is one that is under way.
before(async () => {
  browser = await open_browser();
  rmSync(study, { recursive: true, force: true });
  cpSync(join(kFolder, 'study'), study, { recursive: true });
  for (const derived of [kCell, 'result.json', 'verdict.txt', 'tables']) {
    rmSync(join(study, derived), { recursive: true });
  }
  served = await watch(study);
  address = served.address;
});
after(async () => {
  assert.equal(await end(served.server, 'SIGINT'), 0);
  await browser.close();
});

function ask(options, path = '/') {
  return new Promise((resolve, reject) => {
    const request = http.request(address.replace(/\/$/, path), options, (answer) => {
      let text = '';
      answer.on('data', (data) => (text += data));
      answer.on('end', () => resolve({ status: answer.statusCode, text, headers: answer.headers }));
    });
    request.on('error', reject);
    request.end();
  });
}

test('the page follows the study to its end', async () => {
  const { page, expect_no_faults } = await open_page(browser, address);
  const bar = page.getByRole('progressbar', { name: 'Progress' });
  assert.equal(await bar.getAttribute('aria-valuenow'), '59');
  assert.equal(await bar.getAttribute('aria-valuemax'), '60');
  // The study is not running, so it has no speed.
  assert.match(
    await bar.getAttribute('aria-valuetext'),
    /^59 of 60 cells \(98 %\); time left: unknown yet; (simulations per second: unknown yet|no simulation in the last minute); \d+ candidates have failed$/,
  );
  assert.equal(await page.locator('.state').innerText(), '');
  cpSync(join(kFolder, 'study', kCell), join(study, kCell), {
    recursive: true,
  });
  await page.waitForFunction(() => document.documentElement.dataset.connection === 'finished');
  assert.equal(await page.locator('.state').innerText(), 'Finished');
  assert.equal(await bar.count(), 0);
  expect_no_faults();
  await page.close();
});

// Watches a program at work until its page shows the throughput and `sign`, and looks at its bar.
async function check_progress(command, out, unit, sign) {
  const folder = join(kFolder, out);
  rmSync(folder, { recursive: true, force: true });
  const worker = spawn(process.env.ARMWRIGHT, [...command, '--out', folder, '--quiet'], { stdio: 'ignore' });
  try {
    await new Promise((resolve) => {
      const look = setInterval(() => {
        if (existsSync(join(folder, sign))) {
          clearInterval(look);
          resolve();
        }
      }, 50);
    });
    const { server, address: its_address } = await watch(folder);
    const { page, expect_no_faults } = await open_page(browser, its_address);
    await page.waitForFunction(() =>
      / left; [\d.]+ simulations per second in the last minute/.test(document.querySelector('[role=progressbar]')?.ariaValueText),
    );
    const bar = page.getByRole('progressbar');
    const before = Number(await bar.getAttribute('aria-valuenow'));
    assert.match(await bar.getAttribute('aria-valuetext'), new RegExp(`^${before} of \\d+ ${unit} \\(\\d+ %\\); about \\d+ (s|min|h)`));
    return { page, bar, before, expect_no_faults, server, worker };
  } catch (error) {
    worker.kill('SIGTERM');
    throw error;
  }
}

test('the page of a run in progress has its speed, the time left and its failures', async () => {
  const command = ['optimize', 'q1-complex', '--optimizer', 'ga', '--budget', '10000000', '--jobs', '1'];
  const watched = await check_progress(command, 'run-in-progress', 'cases', 'journal');
  const { page, bar, before } = watched;
  await page.waitForFunction((old) => Number(document.querySelector('[role=progressbar]').ariaValueNow) > old, before);
  assert.equal(await bar.getAttribute('aria-valuemax'), '10000000');
  watched.expect_no_faults();
  await page.close();
  await end(watched.worker, 'SIGTERM');
  assert.equal(await end(watched.server, 'SIGINT'), 0);
});

test('the page of a study in progress has the cells that are running', async () => {
  const command = ['compare', '--problems', 'q1-complex', '--optimizers', 'ga,cmaes', '--replicates', '3', '--engine', 'articulated'];
  const watched = await check_progress([...command, '--budget', '1000000', '--jobs', '1'], 'study-in-progress', 'cells', 'study.toml');
  const { page } = watched;
  const row = page.locator('[data-figure=running] tbody tr').first();
  assert.match(await row.innerText(), /q1-complex.*1000000.*process \d+ on /s);
  watched.expect_no_faults();
  await page.close();
  await end(watched.worker, 'SIGTERM');
  assert.equal(await end(watched.server, 'SIGINT'), 0);
});

// Writes what another process, which runs the missing cell, would write.
function write_attempt(attempt, file, content) {
  mkdirSync(attempt, { recursive: true });
  writeFileSync(join(attempt, file + '.new'), content);
  renameSync(join(attempt, file + '.new'), join(attempt, file));
}

test('an update of the progress touches nothing else', async (t) => {
  const { address: its_address, stop } = await start_watch('watched-for-updates');
  t.after(stop);
  const attempt = join(kFolder, 'watched-for-updates', kCell.replace('cells', 'attempts'), '001');
  const { page, expect_no_faults } = await open_page(browser, its_address);
  const running = page.locator('[data-figure=running]');
  assert.match(await running.innerText(), /No cell is running\./);
  assert.match(await page.locator('[data-figure=failures-so-far]').innerText(), /Nothing has failed\.|diverged/);
  await page.waitForFunction(() => document.querySelectorAll('.cards svg').length > 0);

  // The reader scrolls a table to its end and moves the focus to a heading. Then the page is observed.
  await page.evaluate(() => {
    const box = document.querySelector('[data-figure]:not([data-figure=failures-so-far]) .table-scroll');
    box.style.maxWidth = '100px'; // so that it is cut
    box.scrollLeft = 15;
    box.querySelector('th button').focus({ preventScroll: true });
    window.kept = { box, focus: document.activeElement, changed: [] };
  });
  await draw_frames(page, 2);
  await page.evaluate(() => {
    new MutationObserver((records) => {
      for (const { target } of records) {
        const element = target.nodeType === Node.ELEMENT_NODE ? target : target.parentElement;
        const id = element?.closest('[data-figure]')?.dataset.figure ?? element?.className;
        if (id !== 'running' && id !== 'failures-so-far' && id !== 'cards') {
          window.kept.changed.push(id);
        }
      }
    }).observe(document.querySelector('#panel'), { subtree: true, childList: true, characterData: true, attributes: true });
  });
  const look = () =>
    page.evaluate(() => ({
      changed: [...new Set(window.kept.changed)],
      scroll: window.kept.box.isConnected && window.kept.box.scrollLeft,
      focus: document.activeElement === window.kept.focus,
    }));
  const unchanged = { changed: [], scroll: 15, focus: true };
  assert.deepEqual(await look(), unchanged);

  const owner = { format: 1, host: 'elsewhere', pid: 7, job: '', started: '2026-01-01T00:00:00Z', process_begun_s: 1 };
  write_attempt(attempt, 'attempt.json', JSON.stringify(owner));
  write_attempt(attempt, 'alive', '{"cases":10}');
  await running.locator('tbody tr', { hasText: /r06.*process 7 on elsewhere/s }).waitFor();
  assert.deepEqual(await look(), unchanged);

  // The rows change, and the order of the reader and the focus stay.
  await running.getByRole('button', { name: 'cell' }).click();
  await page.evaluate(() => (window.kept.focus = document.activeElement));
  write_attempt(attempt, 'alive', '{"cases":20}');
  await running.locator('tbody td', { hasText: /^20$/ }).waitFor();
  assert.deepEqual(await look(), unchanged);
  assert.equal(await running.locator('th[aria-sort=ascending]').count(), 1);
  // The downloaded file has the rows that the table shows now.
  const [csv] = await Promise.all([page.waitForEvent('download'), running.getByRole('button', { name: 'CSV' }).click()]);
  assert.match(readFileSync(await csv.path(), 'utf8'), /r06.*,20,/s);

  write_attempt(attempt, 'error.txt', 'the disk is full\n');
  await page.locator('[data-figure=failures-so-far] tbody tr', { hasText: 'the disk is full' }).waitFor();
  assert.match(await running.innerText(), /No cell is running\./);
  assert.deepEqual({ ...(await look()), focus: true }, unchanged);
  expect_no_faults();
  await page.close();
});

test('data that have not changed are not sent again', async () => {
  const first = await ask({}, '/data.json');
  assert.equal(first.status, 200);
  assert.equal(JSON.parse(first.text).kind, 'study');
  const again = await ask({ headers: { 'If-None-Match': first.headers.etag } }, '/data.json');
  assert.equal(again.status, 304);
  assert.equal(again.text, '');
});

test('other hosts, methods and paths are refused', async () => {
  assert.equal((await ask({ headers: { Host: 'evil.example' } })).status, 403);
  assert.equal((await ask({ method: 'POST' })).status, 405);
  assert.equal((await ask({ method: 'DELETE' }, '/data.json')).status, 405);
  assert.equal((await ask({}, '/../../../../etc/passwd')).status, 404);
  assert.equal((await ask({}, '/study.toml')).status, 404);
});

test('another user, who does not know the token, gets nothing', async () => {
  const origin = new URL(address).origin;
  for (const path of ['/', '/data.json', '/00000000000000000000000000000000/data.json']) {
    assert.equal((await fetch(origin + path)).status, 404);
  }
});
