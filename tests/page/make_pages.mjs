// Makes, with the program itself, the pages that the tests open. Usage: node make_pages.mjs FOLDER
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

export const kFolder = process.env.ARMWRIGHT_PAGES ?? process.argv[2];
const kProgram = process.env.ARMWRIGHT;

// The pages show one value per cell of a study, so a study needs fewer than 500 test cases.
const kFewTests = ['--set', 'sets.test_cases=60'];

// A run with a small budget may end with a winner that has a fault (exit code 3), which its page shows.
export function run_program(...args) {
  const { status, stdout, error } = spawnSync(kProgram, args, {
    encoding: 'utf8',
    stdio: ['ignore', 'pipe', 'inherit'],
    maxBuffer: 1 << 28,
  });
  assert.ok(status === 0 || (status === 3 && args[0] === 'optimize'), `${args.join(' ')}: ${error ?? `exit code ${status}`}`);
  return stdout;
}

function make_run() {
  const run = join(kFolder, 'run');
  const as_thesis = ['--optimizer', 'ga', '--set', 'task.ik_bug=true']; // so that there are published numbers to compare with
  run_program('optimize', 'q1-complex', ...as_thesis, '--budget', '1400', '--out', run, '--quiet');
  run_program('report', run, '--out', join(kFolder, 'run.html'), '--quiet');
}

function make_front() {
  const run = join(kFolder, 'front');
  run_program(
    'optimize',
    'q2-pareto',
    '--engine',
    'articulated',
    '--optimizer',
    'pagmo:nsga2',
    '--budget',
    '2000',
    '--out',
    run,
    '--quiet',
  );
  run_program('report', run, '--out', join(kFolder, 'front.html'), '--quiet');
}

function make_function() {
  const run = join(kFolder, 'function');
  run_program('optimize', 'rosenbrock', '--optimizer', 'nlopt:neldermead', '--budget', '300', '--out', run, '--quiet');
  run_program('report', run, '--out', join(kFolder, 'function.html'), '--quiet');
}

// What two recordings of a robot tell of its plant.
function make_identification() {
  const run = join(kFolder, 'identification');
  const logs = join(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../../configs/logs/kr300');
  run_program(
    ...['identify', join(logs, 'trajectory-A.csv'), '--validate', join(logs, 'trajectory-B.csv'), '--robot', 'kr300.urdf'],
    ...['--fit', 'friction,stribeck,armature,payload,counterbalance', '--payload', '200', '--payload-com', '0,0,-0.05'],
    ...['--out', run, '--quiet'],
  );
  run_program('report', run, '--out', join(kFolder, 'identification.html'), '--quiet');
}

// A run of a user's problem, which records signals and files of its winner.
function make_own() {
  const run = join(kFolder, 'own');
  const program = join(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../plugins/problem.py');
  const flags = ['--optimizer', 'random', '--budget', '60', '--out', run, '--quiet'];
  run_program('optimize', `exec:python3 ${program} rich`, ...flags);
  run_program('report', run, '--out', join(kFolder, 'own.html'), '--quiet');
}

function make_study() {
  const study = join(kFolder, 'study');
  run_program(
    ...['compare', '--problems', 'q1-complex,q2-e6', '--optimizers', 'ga,cmaes,nlopt:bobyqa', '--replicates', '6'],
    ...['--budget', '140', '--engine', 'articulated', ...kFewTests, '--out', study, '--quiet'],
  );
  run_program('report', study, '--out', join(kFolder, 'study.html'), '--quiet');
}

// Two runs of one problem, and two studies of which one has fewer problems and optimizers.
function make_comparisons() {
  const run = join(kFolder, 'other-run');
  run_program(
    ...['optimize', 'q1-complex', '--optimizer', 'cmaes', '--set', 'task.ik_bug=true', '--budget', '700', '--out', run, '--quiet'],
  );
  run_program('report', join(kFolder, 'run'), run, '--out', join(kFolder, 'comparison.html'), '--quiet');
  const study = join(kFolder, 'other-study');
  run_program(
    ...['compare', '--problems', 'q1-complex', '--optimizers', 'ga,cmaes', '--replicates', '6', '--budget', '140'],
    ...['--engine', 'articulated', '--set', 'sets.validation_cases=20', ...kFewTests, '--out', study, '--quiet'],
  );
  run_program('report', join(kFolder, 'study'), study, '--out', join(kFolder, 'study-comparison.html'), '--quiet');
}

// The page needs the runs of the thesis, and not their results: 20 generations are enough.
function make_reproduction() {
  const folder = join(kFolder, 'reproduction');
  const configs = join(kFolder, 'configs');
  cpSync(new URL('../../configs', import.meta.url), configs, { recursive: true });
  for (const name of ['initial', 'initial-0cm', 'initial-45cm', '_q2', 'q2-e1', 'q2-e2']) {
    const file = join(configs, 'problems', `${name}.toml`);
    const text = readFileSync(file, 'utf8');
    const shorter = text.replace(/^budget = \d+/m, 'budget = 700');
    assert.notEqual(shorter, text, file);
    writeFileSync(file, shorter);
  }
  // Above the speed that it was tuned for the design diverges in some cases, which is a result (code 3).
  const flags = ['reproduce', '--engine', 'articulated', '--cases', '20', '--out', folder, '--quiet'];
  const { status, stderr } = spawnSync(kProgram, flags, { encoding: 'utf8', env: { ...process.env, ARMWRIGHT_CONFIGS: configs } });
  assert.equal(status, 3, stderr);
  run_program('report', folder, '--out', join(kFolder, 'reproduction.html'), '--quiet');
}

if (process.argv[2] !== undefined) {
  rmSync(kFolder, { recursive: true, force: true });
  mkdirSync(kFolder, { recursive: true });
  make_run();
  make_front();
  make_function();
  make_own();
  make_identification();
  make_study();
  make_comparisons();
  make_reproduction();
}
