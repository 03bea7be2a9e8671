// The page of a study under way, for several tests.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { kFolder } from './make_pages.mjs';

// Starts `armwright watch` on a copy of the study that lacks a cell, so that the study is under way. Each test
// gives a `name` of its own. Returns the address of the page and the function that ends the program.
export async function start_watch(name) {
  const study = join(kFolder, name);
  rmSync(study, { recursive: true, force: true });
  cpSync(join(kFolder, 'study'), study, { recursive: true });
  for (const derived of ['cells/q2-e6/ga/r06', 'result.json', 'verdict.txt', 'tables']) {
    rmSync(join(study, derived), { recursive: true });
  }
  const server = spawn(process.env.ARMWRIGHT, ['watch', study], { stdio: ['ignore', 'pipe', 'inherit'] });
  const said = await new Promise((resolve, reject) => {
    server.stdout.once('data', (data) => resolve(String(data)));
    server.once('exit', (code) => reject(new Error(`watch ended with ${code}`)));
  });
  return {
    address: said.match(/http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\//)[0],
    async stop() {
      server.removeAllListeners('exit');
      const ended = new Promise((resolve) => server.once('exit', resolve));
      server.kill('SIGINT');
      assert.equal(await ended, 0);
    },
  };
}
