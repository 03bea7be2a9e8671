// Names that would be code, markup, or would turn the page around, wherever the page shows one: as
// text they are inert.
import assert from 'node:assert/strict';
import { cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { open_browser, open_page } from './browser.mjs';
import { find_faulty_cards, go_through } from './examine.mjs';
import { kFolder, run_program } from './make_pages.mjs';

const kScript = `</script><script>document.title='PWNED'</script><img src=x onerror="document.title='PWNED'">`;
const kNames = [
  kScript,
  `"'\`\${document.title='PWNED'}`,
  '\u202egnp.txet \u2066esrever\u2069',
  'W'.repeat(4096),
  '=cmd|calc!A1',
  '\u0007\u001b[2J',
];

let browser;
before(async () => {
  browser = await open_browser({ reducedMotion: 'reduce' });
});
after(() => browser.close());

async function expect_inert(file) {
  const { page, expect_no_faults } = await open_page(browser, file);
  const names = new Map();
  await go_through(page, [1280], ['light'], async (tab) => {
    assert.deepEqual(await find_faulty_cards(page, tab, names), [], tab);
    assert.equal(await page.locator('img').count(), 0, `markup came alive in tab ${tab}`);
    assert.equal(await page.locator('#page script').count(), 0);
  });
  assert.notEqual(await page.title(), 'PWNED');
  expect_no_faults();
  await page.close();
}

test('problems, optimizers and folders with hostile names', async () => {
  const folder = join(kFolder, `hostile <b>'"&`);
  rmSync(folder, { recursive: true, force: true });
  // A file extends another beside it.
  cpSync(new URL('../../configs/problems', import.meta.url), folder, { recursive: true });
  const quote = (text) => JSON.stringify(text);
  const problem = join(folder, 'problem.toml');
  writeFileSync(
    problem,
    `extends = "q1-complex"\ntitle = ${quote(kNames.slice(0, 3).join(' '))}\ndescription = ${quote(kNames.slice(0, 4).join(' '))}\n`,
  );
  const study = join(folder, 'study.toml');
  // One that turns the text around is refused as a label; as a title it is none of the terminal's business.
  const labels = [kScript, kNames[1], 'W'.repeat(200)];
  writeFileSync(
    study,
    `title = ${quote(kScript)}\nreplicates = 2\nbudget = 40\nset = ["physics.engine=articulated", "sets.test_cases=20"]\n` +
      `[[problem]]\nname = ${quote(problem)}\nlabel = ${quote(kScript.slice(0, 60))}\n` +
      labels.map((label) => `[[optimizer]]\nname = "random"\nlabel = ${quote(label)}\n`).join(''),
  );
  run_program('compare', study, '--out', join(folder, 'study'), '--quiet');
  run_program('report', join(folder, 'study'), '--out', join(folder, 'study.html'), '--quiet');
  await expect_inert(join(folder, 'study.html'));

  run_program(
    'optimize',
    problem,
    '--engine',
    'articulated',
    '--budget',
    '70',
    '--set',
    'sets.test_cases=20',
    '--out',
    join(folder, 'run'),
    '--quiet',
  );
  run_program('report', join(folder, 'run'), '--out', join(folder, 'run.html'), '--quiet');
  await expect_inert(join(folder, 'run.html'));
});

// Words that the page's code compares with, and commands of ours: all other texts may be anything.
const kWords =
  /^(run|study|reproduction|generation|evaluations|box|cylinder|sphere|mesh|revolute|prismatic|ok|diverged|upper|lower|good|watch|bad|fresh:\d+|fixed:\d+|)$/;
const kKept = new Set(['f32', 'i16', 'u32', 'id', 'design', 'replay', 'case', 'label', 'set', 'used']);

function spoil(value, key, next) {
  if (Array.isArray(value)) {
    return value.map((one) => spoil(one, key, next));
  }
  if (value !== null && typeof value === 'object') {
    return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, spoil(one, name, next)]));
  }
  return typeof value === 'string' && !kWords.test(value) && !kKept.has(key) ? next() + value : value;
}

test('every text of the data replaced by a hostile one', async () => {
  for (const name of ['run', 'study', 'reproduction', 'front']) {
    const html = readFileSync(join(kFolder, name + '.html'), 'utf8');
    const begin = html.indexOf('id="data">') + 'id="data">'.length;
    const end = html.indexOf('</script>', begin);
    let count = 0;
    const spoilt = spoil(JSON.parse(html.slice(begin, end)), '', () => kNames[count++ % kNames.length]);
    assert.ok(count > 20, `${count} texts were replaced`);
    const file = join(kFolder, name + '-hostile.html');
    writeFileSync(file, html.slice(0, begin) + JSON.stringify(spoilt).replaceAll('<', '\\u003c') + html.slice(end));
    await expect_inert(file);
  }
});
