// The page of an identification: two recordings of a robot, of which one was held back.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { appendFileSync, cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { click_plot, find_figure, open_browser, open_page, open_tab } from './browser.mjs';
import { kFolder, run_program } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

const found = () => JSON.parse(readFileSync(join(kFolder, 'identification', 'identification.json'), 'utf8'));
const open = () => open_page(browser, join(kFolder, 'identification.html'));
const get_state = (page) => page.evaluate(() => ({ ...window.armwright_replay.state }));

async function open_motion() {
  const { page, expect_no_faults } = await open();
  await page.setViewportSize({ width: 1280, height: 1900 });
  await open_tab(page, 'motion');
  await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=efforts] .plot svg path').length > 5);
  return { page, expect_no_faults };
}

test('the first screen has the doubts before the errors, and both as they were recorded', async () => {
  const { doubts, fitted, held_back } = found();
  const { page, expect_no_faults } = await open();
  const cards = await page.$$eval('[data-figure]', (all) => all.map((card) => card.dataset.figure));
  assert.deepEqual(cards.slice(0, 3), ['doubts', 'identification', 'fit-table']);
  assert.equal(await page.locator('[data-figure=doubts] tr').count(), doubts.length);
  const values = await page.locator('.tile-value').allInnerTexts();
  [held_back, fitted].forEach((set, i) => {
    const [, before, after] = /^([\d.]+) → ([\d.]+)$/.exec(values[i]);
    assert.ok(Math.abs(before - set.error_before) < 0.001 && Math.abs(after - set.error_after) < 0.001, values[i]);
    assert.ok(Number(after) < Number(before), values[i]);
  });
  assert.equal(await page.locator('[data-figure=fit-table] tbody tr').count(), 2 * fitted.joints.length);
  expect_no_faults();
  await page.close();
});

test('a parameter whose interval has 0 in it is not called told', async () => {
  const { parameters } = found();
  const { page, expect_no_faults } = await open();
  await open_tab(page, 'parameters');
  const states = await page.locator('[data-figure=parameters-table] tbody tr td:last-child').allInnerTexts();
  const zero = parameters.filter((one) => one.determined && !one.at_bound && one.lower <= 0 && one.upper >= 0);
  assert.ok(zero.length > 0);
  assert.equal(states.filter((state) => state === '? may be 0').length, zero.length);
  assert.equal(states[parameters.indexOf(zero[0])], '? may be 0');
  expect_no_faults();
  await page.close();
});

test('the arm moves as it was recorded, with the clock of the torques', async () => {
  const { page, expect_no_faults } = await open_motion();
  const motion = found().motions[1]; // the log that was held back
  const card = await find_figure(page, 'efforts');
  const box = await click_plot(card, 0.6, 0.3);
  const state = await get_state(page);
  assert.equal(state.case, 'log-2');
  assert.ok(state.time_s > 1, `the time is ${state.time_s} s`);
  await page.waitForFunction(() => document.querySelector('.replay-scrub').value !== '0');
  // The angles and torques beside the arm are those of the log.
  const period_s = motion.times_s[1];
  const rows = await page.locator('.replay-joints dd').allInnerTexts();
  rows.forEach((row, i) => {
    const [, angle, torque] = /^(-?[\d.]+)°, (-?[\d.]+) N m$/.exec(row);
    const at = state.time_s / period_s;
    const near = (list) => list.slice(Math.max(0, Math.floor(at) - 1), Math.ceil(at) + 2);
    const angles = near(motion.positions[i]).map((q) => (q * 180) / Math.PI);
    assert.ok(Math.min(...angles) - 0.006 <= angle && angle <= Math.max(...angles) + 0.006, `joint ${i + 1}: ${angle} and ${angles}`);
    const torques = near(motion.recorded[i]);
    const digit = 0.01 * Math.max(...torques.map(Math.abs)) + 0.01;
    assert.ok(Math.min(...torques) - digit <= torque && torque <= Math.max(...torques) + digit, `joint ${i + 1}: ${torque} and ${torques}`);
  });
  // One line crosses the torques and the residuals.
  const line = await card.locator('.cursor').boundingBox();
  assert.ok(line.height > 0.6 * box.height, `the cursor is ${line.height} px high`);
  await page.mouse.move(box.x + box.width * 0.5, box.y + box.height * 0.3);
  const readings = await card.locator('.readings').allInnerTexts();
  assert.equal(readings.length, 2);
  assert.match(readings[0], /recorded[^]*model before[^]*model after/);
  assert.match(readings[1], /residual before[^]*residual after/);
  // Moves, targets and errors make no sense here.
  assert.doesNotMatch(await page.locator('.replay').innerText(), /Previous point|Ghost|Error|target/);
  await page.locator('.replay').getByRole('button', { name: 'Play' }).click();
  await page.waitForFunction((begin) => window.armwright_replay.state.time_s > begin + 0.2, state.time_s);
  await page.locator('.replay').getByRole('button', { name: 'Pause' }).click();
  // Another log in the figure is another log of the replay.
  await card.locator('select').first().selectOption('log-1');
  await page.waitForFunction(() => window.armwright_replay.state.case === 'log-1');
  expect_no_faults();
  await page.close();
});

// The page needs no logs; without the robot's file only the arm is missing.
test('the page of a run whose logs and robot are gone has all but the arm', async () => {
  const folder = join(kFolder, 'identification-gone');
  rmSync(folder, { recursive: true, force: true });
  cpSync(join(kFolder, 'identification'), folder, { recursive: true });
  const manifest = JSON.parse(readFileSync(join(folder, 'manifest.json'), 'utf8'));
  manifest.configuration.problem.identification.logs = ['/nowhere/a.csv'];
  manifest.configuration.problem.robot.urdf = '/nowhere/gone.urdf';
  writeFileSync(join(folder, 'manifest.json'), JSON.stringify(manifest));
  rmSync(join(folder, 'SHA256SUMS'));
  run_program('report', folder, '--out', join(kFolder, 'identification-gone.html'), '--quiet');
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'identification-gone.html'));
  assert.match(await page.locator('.notes').innerText(), /The arm is not shown, because its file cannot be read \(.*gone\.urdf/);
  await open_tab(page, 'motion');
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=efforts] .plot svg path').length > 5);
  assert.equal(await page.locator('.replay').count(), 0);
  expect_no_faults();
  await page.close();
});

test('doctor finds a changed plant, and show prints what identify has found', () => {
  const folder = join(kFolder, 'identification');
  assert.match(run_program('doctor', folder), /All stored files are intact/);
  const shown = run_program('show', folder);
  assert.match(shown, /payload\.mass +200\.0/);
  assert.match(shown, /Held back: .*trajectory-B\.csv/);
  const copy = join(kFolder, 'identification-changed');
  rmSync(copy, { recursive: true, force: true });
  cpSync(folder, copy, { recursive: true });
  appendFileSync(join(copy, 'plant.toml'), '# mine');
  const { status, stdout } = spawnSync(process.env.ARMWRIGHT, ['doctor', copy], { encoding: 'utf8' });
  assert.equal(status, 4);
  assert.match(stdout, /DAMAGED +plant\.toml/);
});
