import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { click_plot, draw_frames, find_figure, list_points, list_tabs, open_browser, open_page, open_tab } from './browser.mjs';
import { settle } from './examine.mjs';
import { kFolder, run_program } from './make_pages.mjs';

let browser;
before(async () => {
  browser = await open_browser();
});
after(() => browser.close());

async function open_run(name = 'run') {
  return open_page(browser, join(kFolder, name + '.html'));
}

async function open_replay(page) {
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    if ((await page.locator('.replay').count()) > 0) {
      return;
    }
  }
  assert.fail('no tab has a replay');
}

const get_state = (page) => page.evaluate(() => ({ ...window.armwright_replay.state }));

test('the first screen of a run has its headlines and the health of the winner', async () => {
  const result = JSON.parse(readFileSync(join(kFolder, 'run', 'result.json'), 'utf8'));
  const { test: judged } = result.winner;
  const get_metric = (name) => judged.metrics[result.metrics.indexOf(name)];
  const { page, expect_no_faults } = await open_run();
  await page.setViewportSize({ width: 1280, height: 800 });
  await open_tab(page, 'overview');
  const tile = async (label, part = 'value') =>
    page
      .locator('.tile', { has: page.getByText(label, { exact: true }) })
      .locator('.tile-' + part)
      .innerText();
  const mean_mm = (1000 * judged.case_errors.reduce((sum, error) => sum + error, 0)) / judged.case_errors.length;
  const { test_motion: motion } = result.winner;
  const mm = (error_m) => (1000 * error_m).toPrecision(3);
  assert.equal(await tile('Error while moving'), `RMS ${mm(motion.error_while_moving_rms_m)} mm`);
  assert.match(await tile('Error while moving', 'detail'), new RegExp(`^peak ${mm(motion.error_while_moving_peak_m)} mm;`));
  assert.equal(await tile('Error after start-up'), `up to ${mm(motion.error_after_start_up_m)} mm`);
  const [, before, after] = /^([\d.]+) → ([\d.]+) mm$/.exec(await tile('Mean error at rest'));
  assert.equal(after, mean_mm.toPrecision(3));
  assert.ok(Number(before) > Number(after), `${before} before, ${after} after`);
  assert.match(await tile('Failed test cases'), new RegExp(` ${judged.failed_cases} of ${judged.case_errors.length}$`));
  assert.equal(await tile('Total torque'), `${Math.round(get_metric('total_torque'))} N m`);
  assert.equal(await tile('Simulations'), String(result.counts.cases));
  const { started } = JSON.parse(readFileSync(join(kFolder, 'run', 'manifest.json'), 'utf8'));
  assert.match(await tile('Time taken'), /^[\d.]+ (s|min|h)( \d+ (s|min))?$/);
  assert.match(await tile('Time taken', 'detail'), new RegExp(`of processor time; started ${started.slice(0, 10)}, `));

  const card = page.locator('[data-figure=health]');
  assert.match(await card.locator('.verdict').innerText(), /the winner is/i);
  // A winner that fails under another condition is not called healthy.
  const { settings } = JSON.parse(readFileSync(join(kFolder, 'run', 'check.json'), 'utf8'));
  const is_failing = settings.some((setting) => setting.verdict === 'fails');
  const mark = await card.locator('tr', { hasText: 'Under other conditions' }).locator('.mark').innerText();
  assert.equal(mark === '✗ bad', is_failing);
  if (is_failing) {
    assert.match(await card.locator('.verdict').innerText(), /^✗ The winner is not healthy: .*fails in \d+ of 10 cases/);
  }
  const box = await card.boundingBox();
  assert.ok(box.y + box.height <= 800, `the card ends at ${box.y + box.height}`);
  // The recorded metric is the mean over joints and test cases. The shares have two digits.
  const saturation = await card.locator('tr', { hasText: 'Saturation' }).locator('td').nth(1).innerText();
  const shares = Array.from(saturation.matchAll(/joint_\d ([\d.e-]+) %/g), (match) => Number(match[1]));
  assert.equal(shares.length, 4);
  const mean = shares.reduce((sum, share) => sum + share, 0) / shares.length;
  const expected = 100 * get_metric('saturated_share');
  assert.ok(Math.abs(mean - expected) <= 0.05 * expected, `${mean} % is not ${expected} %`);
  assert.equal(await card.locator('tr .mark').count(), 8);
  for (const mark of await card.locator('tr .mark').allInnerTexts()) {
    assert.match(mark, /^(✓ good|! watch|✗ bad|– not graded|\? not checked)$/);
  }
  expect_no_faults();
  await page.close();
});

test('a click on the front picks a design that can be saved and evaluated', async () => {
  const { page, expect_no_faults } = await open_run('front');
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    if ((await page.locator('[data-figure=front]').count()) > 0) {
      break;
    }
  }
  const card = await find_figure(page, 'front');
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=front] .plot svg path').length > 5);
  let said = '';
  for (const [x, y] of await list_points(card)) {
    await page.mouse.move(x, y);
    const pointed = await card.locator('.plot').evaluate((one) => one.querySelector('.tip')?.textContent ?? '');
    if (pointed.includes('save this design')) {
      await page.mouse.click(x, y);
      said = await card.locator('.details').innerText();
      break;
    }
  }
  const name = said.match(/Save (front-\d+\.toml)/)?.[1];
  assert.ok(name, said);
  assert.match(said, /Evaluation \d+: error [^]*total torque/);
  const saving = page.waitForEvent('download');
  await card.locator('.save-design').click();
  const saved = await saving;
  assert.equal(saved.suggestedFilename(), name);
  await saved.saveAs(join(kFolder, name));
  const command = await card.locator('.details code').innerText();
  assert.ok(command.startsWith(`armwright evaluate ${name} --problem q2-pareto`), command);
  const words = command.split(' ').slice(3);
  assert.match(run_program('evaluate', join(kFolder, name), ...words, '--cases', '2'), /mean error/);
  // The same without a mouse, in the table.
  await card.getByRole('button', { name: 'Table' }).focus();
  await page.keyboard.press('Enter');
  const dialog = page.locator('dialog[open]');
  await dialog.locator('tbody button.link').first().focus();
  await page.keyboard.press('Enter');
  assert.match(await dialog.innerText(), /Save front-\d+\.toml/);
  expect_no_faults();
  await page.close();
});

test("a run of a user's problem shows its words, limits, signals and files, and no arm", async () => {
  const { page, expect_no_faults } = await open_run('own');
  assert.deepEqual(await list_tabs(page), ['overview', 'training', 'response', 'winner']);
  const variables = await page.locator('[data-figure=variables-table] tbody').innerText();
  assert.match(variables, /integer[^]*plain, dear/);
  assert.match(await page.locator('[data-figure=limits-table] tbody').innerText(), /heat[^]*W[^]*(met|missed)/);
  assert.doesNotMatch(await page.locator('body').innerText(), /joint|torque/i);
  await open_tab(page, 'winner');
  assert.equal(await page.locator('[data-figure=winner-record] h3').innerText(), 'Signals: speed');
  // dot.png does not begin as an image does, so it is only saved.
  assert.equal(await page.locator('[data-figure=winner-files] img').count(), 0);
  assert.deepEqual(await page.locator('[data-figure=winner-files] a').allInnerTexts(), ['dot.png', 'note.txt']);
  expect_no_faults();
  await page.close();
});

test('the replay plays, is scrubbed, and shows the robot', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_replay(page);
  await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);

  const scrub = page.locator('.replay input[type=range]').first();
  await scrub.evaluate((input) => {
    input.value = String(Number(input.max) / 2);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  });
  const middle = await get_state(page);
  assert.ok(middle.time_s > 1, `the time is ${middle.time_s} s`);

  await scrub.focus();
  await page.keyboard.press('ArrowRight');
  const next = await get_state(page);
  assert.equal(next.step, middle.step + 1);

  await page.keyboard.press('Home');
  await page.locator('.replay').getByRole('button', { name: /play/i }).click();
  await page.waitForFunction(() => window.armwright_replay.state.time_s > 0.3);
  await page.locator('.replay').getByRole('button', { name: /pause/i }).click();
  const paused = await get_state(page);
  await draw_frames(page, 10); // while it plays, each frame shows a later step
  assert.equal((await get_state(page)).step, paused.step);

  // Pixels of the robot: many that are not the background's colour.
  const share = await page.evaluate(() => {
    const canvas = document.querySelector('.replay canvas');
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, copy.width, copy.height);
    // The arm is orange: much more red than blue.
    let orange = 0;
    for (let i = 0; i < data.length; i += 4) {
      orange += data[i + 3] > 200 && data[i] > data[i + 2] + 40 ? 1 : 0;
    }
    return orange / (data.length / 4);
  });
  assert.ok(share > 0.005, `${(100 * share).toFixed(2)} % of the view is the robot's colour`);
  expect_no_faults();
  await page.close();
});

test('the replay opens with the median test case of the winner', async () => {
  const { winner } = JSON.parse(readFileSync(join(kFolder, 'run', 'result.json'), 'utf8'));
  const errors = winner.test.case_errors;
  const median = errors.slice().sort((a, b) => a - b)[Math.floor((errors.length - 1) / 2)];
  const { page, expect_no_faults } = await open_run();
  await open_replay(page);
  const [set, number] = (await get_state(page)).case.split(':');
  assert.match(set, /^test/);
  assert.equal(errors[Number(number)], median);
  const chosen = page.locator('.replay label', { hasText: 'Test case' }).locator('option:checked');
  assert.match(await chosen.innerText(), new RegExp(`: the median of ${errors.length} by error$`));
  expect_no_faults();
  await page.close();
});

test('the slider of the replay stands above the cursor of its error', async () => {
  const { page, expect_no_faults } = await open_run();
  for (const width of [390, 1280]) {
    await page.setViewportSize({ width, height: 900 });
    await open_replay(page);
    await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
    await page.locator('.replay-strip').scrollIntoViewIfNeeded();
    const [slider, strip] = await Promise.all(['.replay-scrub', '.replay-strip'].map((one) => page.locator(one).boundingBox()));
    const per_pixel_s = (await page.evaluate(() => Number(document.querySelector('.replay-scrub').max) / 100)) / (strip.width - 74);
    for (const share of [0, 0.3, 0.8, 1]) {
      const x = strip.x + 62 + share * (strip.width - 74);
      await page.mouse.click(x, strip.y + 40);
      const by_strip = await get_state(page);
      await page.waitForFunction(({ step }) => document.querySelector('.replay-scrub').value === String(step), by_strip);
      const cursor = await page.locator('.replay-cursor').evaluate((one) => one.getBoundingClientRect().left);
      assert.ok(Math.abs(cursor - x) <= 1.5, `${width} px, ${share}: the cursor is at ${cursor}, the click at ${x}, step ${by_strip.step}`);
      // A click beside the handle moves its centre to the pointer.
      await page.mouse.click(strip.x + 62 + (share < 0.5 ? 0.9 : 0.1) * (strip.width - 74), strip.y + 40);
      await page.waitForFunction(({ step }) => document.querySelector('.replay-scrub').value !== String(step), by_strip);
      await page.mouse.click(x, slider.y + slider.height / 2);
      const by_slider = await get_state(page);
      const apart_s = Math.abs(by_slider.time_s - by_strip.time_s);
      assert.ok(apart_s <= 2 * per_pixel_s, `${width} px, ${share}: ${by_slider.time_s} s and ${by_strip.time_s} s`);
    }
  }
  expect_no_faults();
  await page.close();
});

test('the arm is seen from above, and its links have the colours of torques or of joint limits', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_replay(page);
  await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
  const count_orange = () =>
    page.evaluate(() => {
      const canvas = document.querySelector('.replay canvas');
      const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
      const context = copy.getContext('2d');
      context.drawImage(canvas, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      let orange = 0;
      for (let i = 0; i < data.length; i += 4) {
        orange += data[i] > data[i + 2] + 60 ? 1 : 0;
      }
      return orange / (data.length / 4);
    });
  // A change asks for the next frame, so the picture has followed it after that frame.
  const draw = async (change) => {
    await change();
    await draw_frames(page, 2);
    return count_orange();
  };
  const from_side = await draw(() => page.getByRole('button', { name: 'Side' }).click());
  const from_above = await draw(() => page.getByRole('button', { name: 'Top' }).click());
  assert.ok(from_above > 0.001 && Math.abs(from_above - from_side) > 0.1 * from_side, `${from_above} and ${from_side}`);
  const select = page.locator('.replay label', { hasText: /^Arm/ }).locator('select');
  for (const paint of ['torque', 'position']) {
    const before = await draw(() => select.selectOption('robot'));
    const after = await draw(() => select.selectOption(paint));
    assert.ok(after < 0.6 * before, `${paint}: ${after} after ${before}`);
    assert.equal(await page.locator('.replay-paints > span').count(), 6);
    const rows = await page.locator('.replay-joints dd').allInnerTexts();
    rows.forEach((row) => assert.match(row, paint === 'torque' ? /, –$/ : /, (\d+ %|at the limit|–)$/));
  }
  expect_no_faults();
  await page.close();
});

async function open_motion(width = 1280) {
  const { page, expect_no_faults } = await open_run();
  await page.setViewportSize({ width, height: 900 });
  await open_replay(page);
  await page.waitForFunction(() => window.armwright_replay?.state.frames > 0);
  await settle(page);
  return { page, expect_no_faults };
}

const find_plot = async (page, id) => (await find_figure(page, id)).locator('.plot').boundingBox();
const get_readings = (page, id) =>
  page.$$eval(`[data-figure=${id}] .readings tr`, (rows) => rows.map((row) => Array.from(row.children, (cell) => cell.textContent)));

test('the replay and the plots over time share their cursor', async () => {
  const { page, expect_no_faults } = await open_motion();
  const card = await find_figure(page, 'joint-torques');
  const box = await click_plot(card, 0.6, 0.5);
  const state = await get_state(page);
  assert.ok(state.time_s > 1, `the time is ${state.time_s} s`);
  const left = await card.locator('.cursor').evaluate((cursor) => cursor.getBoundingClientRect().left);
  assert.ok(Math.abs(left - (box.x + box.width * 0.6)) < 3, `the cursor is at ${left}`);
  assert.equal(await page.locator('[data-figure=joint-angles] .cursor').isVisible(), true);

  // In a panel of the third move, a click goes to the time of the case.
  await click_plot(await find_figure(page, 'momentary-error'), 0.5, 0.3);
  const in_move = await get_state(page);
  assert.notEqual(in_move.time_s, state.time_s);
  const [[, local_s]] = await get_readings(page, 'momentary-error');
  const segment_s = in_move.time_s - Number(local_s);
  const [[, case_s]] = await get_readings(page, 'joint-angles');
  assert.ok(segment_s > 1 && Math.abs(Number(case_s) - in_move.time_s) < 0.005, `${local_s} s in the move, ${case_s} s in the case`);
  expect_no_faults();
  await page.close();
});

for (const width of [390, 1280]) {
  test(`the pointer over one plot shows the values at this time in all, at ${width} px`, async () => {
    const { page, expect_no_faults } = await open_motion(width);
    const box = await find_plot(page, 'joint-torques');
    await page.mouse.move(box.x + box.width * 0.6, box.y + box.height * 0.6);
    const [[name, time], joint] = await get_readings(page, 'joint-torques');
    assert.equal(name, 'time (s)');
    assert.match(joint[0], /^joint_1/);
    for (const [id, rows] of Object.entries({ 'joint-angles': 9, 'joint-errors': 5 })) {
      const readings = await get_readings(page, id);
      assert.equal(readings.length, rows, id);
      assert.deepEqual(readings[0], [name, time]);
      readings.forEach((row) => assert.match(row[1], /\d/));
      const [inner, outer] = await page.evaluate(
        (figure) =>
          ['.readings', '.frame'].map((part) => document.querySelector(`[data-figure=${figure}] ${part}`).getBoundingClientRect()),
        id,
      );
      const over = Math.max(outer.left - inner.left, inner.right - outer.right, outer.top - inner.top, inner.bottom - outer.bottom);
      assert.ok(over <= 0.5, `the values of ${id} leave their frame by ${over} px`);
    }
    // The value is that of the table at this time.
    const angle = Number((await get_readings(page, 'joint-angles'))[1][1]);
    const [errors] = await Promise.all([
      page.waitForEvent('download'),
      page.locator('[data-figure=joint-angles]').getByRole('button', { name: 'CSV' }).click(),
    ]);
    const lines = readFileSync(await errors.path(), 'utf8')
      .trim()
      .split('\r\n');
    const near = lines
      .slice(1)
      .map((line) => line.split(',').map(Number))
      .filter((row) => Math.abs(row[0] - Number(time)) < 0.03);
    assert.ok(
      near.length >= 4 && near.some((row) => Math.abs(row[1] - angle) < 0.5),
      `${angle} is not one of ${near.map((row) => row[1])}`,
    );
    // The strip of the replay takes part: its line is at the same share of the case.
    const again = await find_plot(page, 'joint-torques');
    const strip = await page.locator('.replay-strip').boundingBox();
    const whole_s = (await page.evaluate(() => Number(document.querySelector('.replay-scrub').max))) / 100;
    await page.mouse.move(again.x + again.width * 0.6, again.y + again.height * 0.6);
    const mark = await page.locator('.replay-pointer').evaluate((one) => one.getBoundingClientRect().left);
    const expected = strip.x + 62 + (Number(time) / whole_s) * (strip.width - 74);
    assert.ok(Math.abs(mark - expected) <= 1.5, `the line of the strip is at ${mark}, not ${expected}`);
    await page.locator('.replay-strip').scrollIntoViewIfNeeded();
    const seen = await page.locator('.replay-strip').boundingBox();
    await page.mouse.move(seen.x + 62 + 0.25 * (seen.width - 74), seen.y + 40);
    const [[, pointed]] = await get_readings(page, 'joint-errors');
    assert.ok(Math.abs(Number(pointed) - 0.25 * whole_s) < 0.02 * whole_s, `${pointed} s is not a quarter of ${whole_s} s`);
    await page.mouse.move(seen.x + seen.width / 2, seen.y + seen.height + 12);
    assert.equal(await page.locator('.readings').count(), 0);
    expect_no_faults();
    await page.close();
  });
}

test('a drag zooms all plots of a motion, and a click, Escape and a double click end it', async () => {
  const { page, expect_no_faults } = await open_motion();
  const reset = (id) => page.locator(`[data-figure=${id}] .reset-zoom`);
  const get_ticks = (id) =>
    page.$$eval(`[data-figure=${id}] .plot svg text`, (texts) =>
      texts.map((text) => text.textContent).filter((text) => /^-?[\d.]+$/.test(text)),
    );
  const drag = async (id) => {
    const box = await find_plot(page, id);
    await page.mouse.move(box.x + box.width * 0.4, box.y + box.height * 0.5);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.45, box.y + box.height * 0.55, { steps: 4 });
    assert.equal(await page.locator(`[data-figure=${id}] .zoom-band`).isVisible(), true);
    await page.mouse.up();
    return box;
  };
  const before = await get_ticks('joint-angles');
  assert.equal(await page.locator('.reset-zoom:visible').count(), 0);
  const ends = {
    button: async () => reset('joint-errors').click(),
    Escape: async () => page.keyboard.press('Escape'),
    'a double click': async (box) => page.mouse.dblclick(box.x + box.width * 0.5, box.y + box.height * 0.6),
  };
  for (const [name, end] of Object.entries(ends)) {
    const { time_s } = await get_state(page);
    const box = await drag('joint-torques');
    assert.equal((await get_state(page)).time_s, time_s, 'a drag is no click');
    for (const id of ['joint-angles', 'joint-errors', 'joint-torques']) {
      assert.equal(await reset(id).isVisible(), true, id);
    }
    assert.notDeepEqual(await get_ticks('joint-angles'), before);
    assert.equal(await page.locator('[data-figure=joint-torques] .zoom-band').isVisible(), false);
    // A click goes to a time within the zoomed range.
    await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.5);
    const clicked = await get_state(page);
    const [[, time]] = await get_readings(page, 'joint-torques');
    assert.ok(Math.abs(clicked.time_s - Number(time)) < 0.005, `${clicked.time_s} is not ${time}`);
    await end(box);
    assert.equal(await page.locator('.reset-zoom:visible').count(), 0, name);
    assert.deepEqual(await get_ticks('joint-angles'), before, name);
  }
  // The plots of another motion have their own zoom.
  await drag('joint-angles');
  await page.locator('[data-figure=joint-angles] label', { hasText: 'case' }).locator('select').selectOption({ index: 1 });
  assert.equal(await page.locator('.reset-zoom:visible').count(), 0);
  expect_no_faults();
  await page.close();
});

test('the training has a zoom of its own, for each abscissa', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_tab(page, 'training');
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=fitness] .plot svg path').length > 5);
  const box = await find_plot(page, 'fitness');
  await page.mouse.move(box.x + box.width * 0.5, box.y + box.height * 0.5);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.9, box.y + box.height * 0.5, { steps: 4 });
  await page.mouse.up();
  assert.equal(await page.locator('[data-figure=fitness] .reset-zoom').isVisible(), true);
  assert.equal(await page.locator('.reset-zoom:visible').count(), 1);
  const abscissa = page.locator('[data-figure=fitness] label', { hasText: 'against' }).locator('select');
  await abscissa.selectOption('cases');
  assert.equal(await page.locator('.reset-zoom:visible').count(), 0);
  await abscissa.selectOption('index');
  assert.equal(await page.locator('.reset-zoom:visible').count(), 1);
  expect_no_faults();
  await page.close();
});

test('a finger scrolls over a plot, and a tap shows the values', async () => {
  const { page, expect_no_faults } = await open_motion(390);
  const box = await find_plot(page, 'joint-angles');
  const session = await page.context().newCDPSession(page);
  const [x, y] = [box.x + box.width * 0.5, box.y + box.height * 0.6];
  const touch = (type, place) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: place === null ? [] : [{ x: place[0], y: place[1] }] });
  const before = await page.evaluate(() => scrollY);
  await touch('touchStart', [x, y]);
  for (let k = 1; k <= 10; ++k) {
    await touch('touchMove', [x, y - 15 * k]);
  }
  await touch('touchEnd', null);
  await page.waitForFunction((start) => scrollY > start + 50, before);
  assert.equal(await page.locator('.reset-zoom:visible').count(), 0);
  const moved = await find_plot(page, 'joint-angles');
  const place = [moved.x + moved.width * 0.5, moved.y + moved.height * 0.6];
  await touch('touchStart', place);
  await touch('touchEnd', null);
  await page.waitForSelector('[data-figure=joint-angles] .readings');
  expect_no_faults();
  await page.close();
});

test('a figure says its numbers: under the pointer, as a table, as CSV, as SVG', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_tab(page, 'response');
  const card = await find_figure(page, 'distance-response');
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=distance-response] .plot svg path').length > 5);

  let shown = '';
  for (const [x, y] of await list_points(card)) {
    await page.mouse.move(x, y);
    shown = await card.evaluate((element) => {
      const tip = element.querySelector('.tip');
      return tip !== null && tip.offsetParent !== null && getComputedStyle(tip).visibility === 'visible' ? tip.textContent : '';
    });
    if (shown !== '') {
      break;
    }
  }
  assert.match(shown, /\d/);

  await card.getByRole('button', { name: 'Table' }).click();
  assert.ok((await page.locator('dialog tbody tr').count()) >= 25);
  await page.keyboard.press('Escape');
  await page.waitForSelector('dialog', { state: 'detached' });

  const [csv] = await Promise.all([page.waitForEvent('download'), card.getByRole('button', { name: 'CSV' }).click()]);
  assert.equal(csv.suggestedFilename(), 'distance-response.csv');
  const lines = readFileSync(await csv.path(), 'utf8')
    .trim()
    .split('\r\n');
  assert.ok(lines.length >= 26, `${lines.length} lines`);
  assert.match(lines[0], /distance/i);

  const [svg] = await Promise.all([page.waitForEvent('download'), card.getByRole('button', { name: 'SVG' }).click()]);
  const text = readFileSync(await svg.path(), 'utf8');
  assert.match(text, /^<svg [^]*<\/svg>\s*$/);
  // In a page of its own: this one's policy would refuse the styles that stand in an SVG.
  const blank = await browser.context.newPage();
  const parsed = await blank.evaluate(
    (source) => new DOMParser().parseFromString(source, 'image/svg+xml').querySelector('parsererror') === null,
    text,
  );
  await blank.close();
  assert.ok(parsed, 'the SVG is not well-formed');
  // The same code draws without a browser.
  const plotted = run_program('plot', join(kFolder, 'run.html'), '--figure', 'distance-response', '--out', '-');
  // But for the place of words, which depends on how wide a browser's letters are.
  const list_drawn = (svg) =>
    svg
      .replace(/zr\d+-/g, 'zr-')
      .split(/(?<=>)/)
      .filter((element) => element.includes('ecmeta_ssr_type="chart"'));
  assert.ok(list_drawn(text).length > 100);
  assert.deepEqual(list_drawn(plotted), list_drawn(text));
  const list_words = (svg) => Array.from(svg.matchAll(/<text[^>]*>([^<]*)</g), (match) => match[1]);
  assert.deepEqual(list_words(plotted), list_words(text));
  expect_no_faults();
  await page.close();
});

test('a series is switched off and on, and shown alone', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_tab(page, 'training');
  const card = await find_figure(page, 'fitness');
  const count = () => card.evaluate((element) => element.querySelectorAll('.plot svg path').length);
  // The chart follows a click in one of the next frames.
  const wait_for_paths = async (least, most, what) => {
    await page
      .waitForFunction(
        ([low, high]) => {
          const { length } = document.querySelectorAll('[data-figure=fitness] .plot svg path');
          return length >= low && length <= high;
        },
        [least, most],
      )
      .catch(async () => assert.fail(`${await count()} paths ${what}, not ${least} to ${most}`));
    return count();
  };
  await page.waitForFunction(() => document.querySelectorAll('[data-figure=fitness] .plot svg path').length > 5);
  const all = await count();
  const entry = card.locator('.plot svg text', { hasText: /average|mean/i }).first();
  await entry.click();
  const fewer = await wait_for_paths(1, all - 1, 'without a series');
  await entry.click();
  await wait_for_paths(all, all, 'with all series');

  // A double click, or a click with Alt, shows a series alone, and again shows all of them.
  await entry.dblclick();
  const alone = await wait_for_paths(1, fewer - 1, 'of a series alone');
  await entry.dblclick();
  await wait_for_paths(all, all, 'with all series after a double click');
  await entry.click({ modifiers: ['Alt'] });
  await wait_for_paths(alone, alone, 'of a series alone after a click with Alt');
  await entry.hover();
  await page.waitForFunction(() =>
    /Double-click or Alt-click/.test(document.querySelector('[data-figure=fitness] .tip')?.textContent ?? ''),
  );
  expect_no_faults();
  await page.close();
});

test('a table sorts by a column, up and down, by key too', async () => {
  const { page, expect_no_faults } = await open_run();
  await open_tab(page, 'design');
  const card = await find_figure(page, 'design-table');
  const column = 2; // the winner's
  const read = async () =>
    (await card.locator(`tbody tr td:nth-child(${column + 1})`).evaluateAll((cells) => cells.map((cell) => Number(cell.title)))).filter(
      (value) => !Number.isNaN(value),
    );
  const sort = card.locator('th .sort').nth(column);
  await sort.click();
  const up = await read();
  assert.deepEqual(
    up,
    up.slice().sort((a, b) => a - b),
  );
  await sort.press('Enter');
  const down = await read();
  assert.deepEqual(down, up.slice().reverse());
  assert.ok(up.length >= 20 && up[0] < up[up.length - 1]);
  expect_no_faults();
  await page.close();
});

test('tabs are reached by keys, and paper shows everything in light', async () => {
  const { page, expect_no_faults } = await open_run();
  const tabs = await list_tabs(page);
  await page.focus(`[role=tab][data-tab="${tabs[0]}"]`);
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.getAttribute('[role=tab][aria-selected=true]', 'data-tab'), tabs[1]);
  await page.keyboard.press('End');
  assert.equal(await page.getAttribute('[role=tab][aria-selected=true]', 'data-tab'), tabs[tabs.length - 1]);

  await page.click('.theme');
  const pdf = await page.pdf({ format: 'A4', landscape: true });
  assert.ok(pdf.length > 100_000, `${pdf.length} bytes of PDF`);
  expect_no_faults();
  await page.close();
});
