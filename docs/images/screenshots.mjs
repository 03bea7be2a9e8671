// The pictures in README.md and docs/, taken of the pages in results/. scripts/screenshots runs it.
import { fileURLToPath } from 'node:url';
import { list_tabs, open_browser, open_page, open_tab } from '../../tests/page/browser.mjs';

const kRoot = fileURLToPath(new URL('../../', import.meta.url));
const browser = await open_browser();

async function open(folder, theme) {
  const { page } = await open_page(browser, `${kRoot}results/${folder}/report.html`);
  if ((await page.getAttribute('html', 'data-theme')) !== theme) {
    await page.click('.theme');
  }
  return page;
}

async function shoot(target, name) {
  await target.screenshot({ path: `${kRoot}docs/images/${name}.png` });
  console.log(`docs/images/${name}.png`);
}

// The arm half-way through its first recorded test case.
const run = await open('q1-complex-ga-seed1', 'light');
for (const tab of await list_tabs(run)) {
  await open_tab(run, tab);
  if ((await run.locator('.replay').count()) > 0) {
    break;
  }
}
await run.waitForFunction(() => window.armwright_replay?.state.frames > 0);
await run
  .locator('.replay input[type=range]')
  .first()
  .evaluate((input) => {
    input.value = String(Math.round(Number(input.max) * 0.31));
    input.dispatchEvent(new Event('input', { bubbles: true }));
  });
await run.waitForTimeout(500);
await shoot(run.locator('.card', { has: run.locator('.replay') }), 'replay');
await open_tab(run, 'response');
await run.waitForTimeout(500);
await shoot(run, 'response');

const study = await open('q1', 'light');
await study.waitForTimeout(500);
await shoot(study, 'verdict');
await open_tab(study, (await list_tabs(study))[1]);
await study.waitForTimeout(500);
await shoot(study, 'comparison');

const thesis = await open('reproduction', 'dark');
await open_tab(thesis, 'q2');
await thesis.waitForTimeout(500);
await shoot(thesis, 'thesis');
await browser.close();
