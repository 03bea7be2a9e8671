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

// Shoots the arm in the replay that the page opens with, after a share of the time at which it rests.
async function shoot_replay(folder, name, share) {
  const page = await open(folder, 'light');
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    if ((await page.locator('.replay').count()) > 0) {
      break;
    }
  }
  await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
  await page
    .locator('.replay input[type=range]')
    .first()
    .evaluate((input, share) => {
      input.value = String(Math.round(Number(input.max) * share));
      input.dispatchEvent(new Event('input', { bubbles: true }));
    }, share);
  await page.waitForTimeout(500);
  await shoot(page.locator('.card', { has: page.locator('.replay') }), name);
}

await shoot_replay('irb4600-auto-seed1', 'replay', 0.3665);
await shoot_replay('my_arm-auto-seed1-tip_tool', 'robot', 0.31);

const study = await open('irb4600', 'light');
await study.waitForTimeout(500);
await shoot(study, 'verdict');
await open_tab(study, (await list_tabs(study))[1]);
await study.waitForTimeout(500);
await shoot(study, 'comparison');
await browser.close();
