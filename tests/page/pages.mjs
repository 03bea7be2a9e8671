// The pages that several tests go through: those of runs, studies and a reproduction, the page of a
// study under way, the data sheet of a run, and the site of the documentation.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { kFolder, run_program } from './make_pages.mjs';

export const kReports = ['run', 'study', 'front', 'reproduction', 'function', 'own', 'identification', 'comparison', 'study-comparison'];

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

// Writes the data sheet of the run and returns its file.
export function make_datasheet(name) {
  const out = join(kFolder, name);
  rmSync(out, { recursive: true, force: true });
  run_program('export', join(kFolder, 'run'), '--format', 'datasheet', '--out', out);
  return join(out, 'datasheet.html');
}
