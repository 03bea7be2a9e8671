// Every figure of every page as a file, without a browser.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { kFolder, run_program } from './make_pages.mjs';

function fail_program(...args) {
  try {
    execFileSync(process.env.ARMWRIGHT, args, { encoding: 'utf8', stdio: 'pipe' });
  } catch (error) {
    return { code: error.status, said: error.stderr };
  }
  return assert.fail('it was done');
}

const kSample = ['run', 'study', 'comparison'];
const kOthers = ['front', 'function', 'reproduction', 'study-comparison']; // in the long tests (../long-tests.md)
for (const name of process.env.ARMWRIGHT_LONG_TESTS === undefined ? kSample : [...kSample, ...kOthers]) {
  test(`all figures of the page ${name}`, () => {
    const page = join(kFolder, name + '.html');
    const folder = join(kFolder, name + '-figures');
    rmSync(folder, { recursive: true, force: true });
    run_program('plot', page, '--out', folder);
    const files = readdirSync(folder);
    const drawn = files.filter((file) => file.endsWith('.svg'));
    assert.ok(drawn.length >= 2, files.join(', '));
    for (const file of drawn) {
      const text = readFileSync(join(folder, file), 'utf8');
      assert.match(text, /^<svg [^]*<\/svg>\n$/);
      assert.ok(!/NaN|undefined|Infinity/.test(text), `${file} has a number that is none`);
      assert.ok(files.includes(file.replace('.svg', '.csv')), `${file} has no table`);
    }
    for (const file of files.filter((one) => one.endsWith('.csv'))) {
      const lines = readFileSync(join(folder, file), 'utf8');
      assert.ok(!/\b(NaN|undefined|Infinity)\b/.test(lines), `${file} has a number that is none`);
    }
    assert.equal(run_program('plot', page, '--list').trim().split('\n').length > drawn.length, true);
  });
}

test('choices change the figure, and wrong ones are refused with what there is', () => {
  const page = join(kFolder, 'run.html');
  const list = run_program('plot', page, '--list');
  const [, choice, first, second] = list.match(/^joint-torques .*?(\w[\w-]*)=([^|;\s]+)\|([^|;\s]+)/m);
  const draw = (value) => run_program('plot', page, '--figure', 'joint-torques', '--choose', `${choice}=${value}`, '--out', '-');
  assert.notEqual(draw(first), draw(second));
  // Equal numbers keep their order: many variables have the importance 0.
  const draw_importance = () => run_program('plot', page, '--figure', 'importance-run', '--out', '-');
  assert.equal(draw_importance(), draw_importance());

  const wrong = fail_program('plot', page, '--figure', 'joint-torques', '--choose', `${choice}=nonsense`, '--out', '-');
  assert.equal(wrong.code, 2);
  assert.ok(wrong.said.includes(first), wrong.said);
  const unknown = fail_program('plot', page, '--figure', 'distance-respons', '--out', '-');
  assert.equal(unknown.code, 2);
  assert.match(unknown.said, /did you mean 'distance-response'/);
  assert.equal(fail_program('plot', page, '--size', '640').code, 2);
  assert.equal(fail_program('plot', page, '--out', '-').code, 2);
});

test('files that are no pages and folders that are no results are refused', () => {
  const no_page = fail_program('plot', join(kFolder, 'run/manifest.json'));
  assert.equal(no_page.code, 4);
  assert.match(no_page.said, /manifest\.json/);
  assert.equal(fail_program('report', kFolder).code, 2);
  const taken = fail_program('report', join(kFolder, 'study'), '--out', join(kFolder, 'study/study.toml'));
  assert.equal(taken.code, 2);
  assert.match(taken.said, /study\.toml/);
});
