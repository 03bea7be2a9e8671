// Measures the size of the page of a large comparison, the time to open it, and how smoothly a
// replay can be scrubbed, in headless Chromium with software rendering.
//   node benchmarks/page.mjs STUDY.html RUN.html
import { statSync } from 'node:fs';
import { list_tabs, open_browser, open_page, open_tab } from '../tests/page/browser.mjs';

const [study, run] = process.argv.slice(2);
if (run === undefined) {
  console.error('usage: node benchmarks/page.mjs STUDY.html RUN.html');
  process.exit(2);
}
const kRepetitions = 5;
const browser = await open_browser();

const sort = (values) => values.slice().sort((a, b) => a - b);
const opening = [];
const switching = [];
for (let i = 0; i < kRepetitions; ++i) {
  const begin = performance.now();
  const { page } = await open_page(browser, study);
  await page.waitForFunction(() => document.querySelector('.plot svg path') !== null);
  opening.push((performance.now() - begin) / 1000);
  for (const tab of await list_tabs(page)) {
    const at = performance.now();
    await open_tab(page, tab);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    switching.push((performance.now() - at) / 1000);
  }
  await page.close();
}
console.log(`${study}: ${(statSync(study).size / 1e6).toFixed(2)} MB`);
console.log(
  `opens in ${sort(opening)
    .map((s) => s.toFixed(2))
    .join(', ')} s; a tab in at most ${Math.max(...switching).toFixed(2)} s`,
);

const { page } = await open_page(browser, run);
for (const tab of await list_tabs(page)) {
  await open_tab(page, tab);
  if ((await page.locator('.replay').count()) > 0) {
    break;
  }
}
await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
// Requests another place in every frame, as fast as the browser draws frames.
const rates = await page.evaluate(async (repetitions) => {
  const input = document.querySelector('.replay input[type=range]');
  const found = [];
  for (let i = 0; i < repetitions; ++i) {
    const before = window.armwright_replay.state.frames;
    const begin = performance.now();
    let now = begin;
    while (now - begin < 3000) {
      input.value = String(Math.round(((now - begin) / 3000) * Number(input.max)));
      input.dispatchEvent(new Event('input', { bubbles: true }));
      now = await new Promise((done) => requestAnimationFrame(() => done(performance.now())));
    }
    found.push((window.armwright_replay.state.frames - before) / ((now - begin) / 1000));
  }
  return found;
}, kRepetitions);
console.log(
  `${run}: ${(statSync(run).size / 1e6).toFixed(2)} MB, scrubs at ${sort(rates)
    .map((rate) => rate.toFixed(0))
    .join(', ')} frames a second`,
);
await browser.close();
