import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, rmSync } from 'node:fs';
import http from 'node:http';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open_browser, open_page } from './browser.mjs';
import { kFolder } from './make_pages.mjs';

let browser;
let server;
let address;
const kCell = 'cells/q2-e6/ga/r06';
const study = join(kFolder, 'watched');

// A study that lacks a cell is one that is under way.
before(async () => {
  browser = await open_browser();
  rmSync(study, { recursive: true, force: true });
  cpSync(join(kFolder, 'study'), study, { recursive: true });
  for (const derived of [kCell, 'result.json', 'verdict.txt', 'tables']) {
    rmSync(join(study, derived), { recursive: true });
  }
  server = spawn(process.env.ARMWRIGHT, ['watch', study], {
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const said = await new Promise((resolve, reject) => {
    server.stdout.once('data', (data) => resolve(String(data)));
    server.once('exit', (code) => reject(new Error(`watch ended with ${code}`)));
  });
  address = said.match(/http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\//)[0];
});
after(async () => {
  server.removeAllListeners('exit');
  const ended = new Promise((resolve) => server.once('exit', resolve));
  server.kill('SIGINT');
  assert.equal(await ended, 0);
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
  assert.match(await page.locator('.state').innerText(), /47 of 48 cells/);
  cpSync(join(kFolder, 'study', kCell), join(study, kCell), {
    recursive: true,
  });
  await page.waitForFunction(() => document.documentElement.dataset.connection === 'finished');
  assert.equal(await page.locator('.state').innerText(), '');
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
