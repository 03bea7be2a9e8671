// The layout of the pages at the widths of a telephone, a tablet and two screens, in either theme. The
// page does not scroll sideways, nothing leaves its card, no label is broken within a word, a box that
// is cut shows that it is, Play is in reach, and the texts of charts are level, whole and apart.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { list_tabs, open_browser, open_page, open_tab } from './browser.mjs';
import { kFolder } from './make_pages.mjs';
import { kReports, make_datasheet, start_watch } from './pages.mjs';

const kWidths = [
  [390, 1280],
  [768, 1920],
];
const kHeight = 844; // pixels, of a telephone's screen

let browser;
before(async () => {
  browser = await open_browser({ reducedMotion: 'reduce' });
});
after(() => browser.close());

// Charts draw again in the frame after a change of their size.
async function settle(page) {
  await page.waitForFunction(() =>
    Array.from(document.querySelectorAll('.plot')).every(
      (plot) => plot.querySelector('svg')?.getAttribute('width') === String(plot.clientWidth),
    ),
  );
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

// Returns one sentence per fault of the layout that is now on the screen. Runs in the page.
function find_faults() {
  const kRounding_px = 1; // boxes end at fractions of a pixel
  const faults = [];
  const root = document.documentElement;
  if (root.scrollWidth > root.clientWidth + kRounding_px) {
    faults.push(`the page is ${root.scrollWidth} px wide on a screen of ${root.clientWidth} px`);
  }

  const name = (element) => {
    const words = element.textContent.trim().replace(/\s+/g, ' ').slice(0, 40);
    return `${element.tagName.toLowerCase()}.${element.getAttribute('class') ?? ''} "${words}"`;
  };
  const is_scrollable = (element) => /auto|scroll/.test(getComputedStyle(element).overflowX + getComputedStyle(element).overflowY);
  const is_visible = (element) => element.getClientRects().length > 0 && element.checkVisibility({ checkVisibilityCSS: true }); // what is folded has boxes, too

  // A box that scrolls or clips may contain more than it shows, but lies within its card itself.
  const check_children = (card, box, parent) => {
    for (const child of parent.children) {
      const rect = child.getBoundingClientRect();
      if (!is_visible(child) || rect.width === 0 || rect.height === 0) {
        continue;
      }
      const over = Math.max(box.left - rect.left, rect.right - box.right, box.top - rect.top, rect.bottom - box.bottom);
      if (over > kRounding_px) {
        faults.push(`${name(child)} leaves the card ${card.dataset.figure ?? 'of the sheet'} by ${over.toFixed(0)} px`);
      } else if (!is_scrollable(child) && getComputedStyle(child).overflowX !== 'hidden' && child.tagName !== 'svg') {
        check_children(card, box, child);
      }
    }
  };
  // A data sheet has no cards, and everything lies within its text.
  document.querySelectorAll('.card, body > main').forEach((card) => check_children(card, card.getBoundingClientRect(), card));

  // A box with hidden content is named, reached by the keyboard, and has a shadow at each cut edge
  // and a sentence below.
  for (const box of document.querySelectorAll('#page *')) {
    if (!is_visible(box) || !is_scrollable(box)) {
      continue;
    }
    const right = box.scrollWidth - box.clientWidth - box.scrollLeft > kRounding_px;
    const below = box.scrollHeight - box.clientHeight - box.scrollTop > kRounding_px;
    if (!right && !below) {
      continue;
    }
    if (box.tabIndex !== 0 || box.getAttribute('role') !== 'region' || !box.getAttribute('aria-label')) {
      faults.push(`${name(box)} is cut, and the keyboard does not reach it as a named region`);
    }
    const frame = box.parentElement;
    const has_shadow = (edge) => {
      const shadow = frame.querySelector(`:scope > .cut-${edge}`);
      return shadow !== null && is_visible(shadow) && shadow.getBoundingClientRect().width > 5 && shadow.getBoundingClientRect().height > 5;
    };
    for (const [edge, is_cut] of Object.entries({ right, bottom: below })) {
      if (is_cut !== has_shadow(edge)) {
        faults.push(`${name(box)} is ${is_cut ? '' : 'not '}cut at the ${edge}, and shows ${is_cut ? 'no' : 'a'} shadow there`);
      }
    }
    const hint = frame.querySelector(':scope > .cut-hint');
    if (hint === null || !is_visible(hint) || !/scroll/i.test(hint.textContent)) {
      faults.push(`${name(box)} is cut, and no sentence says so`);
    }
  }

  // Where the page has two columns of cards, every table has room for all of its columns.
  if (root.clientWidth >= 1200) {
    for (const box of document.querySelectorAll('.table-scroll')) {
      if (box.scrollWidth > box.clientWidth + kRounding_px) {
        faults.push(`${name(box)} needs ${box.scrollWidth} px and has ${box.clientWidth} px`);
      }
    }
  }

  // The title has three quarters of the head's width.
  const [head, titles] = ['header', '.titles'].map((one) => document.querySelector(one)?.getBoundingClientRect().width);
  if (titles < 0.75 * head) {
    faults.push(`the title has ${titles.toFixed(0)} px of ${head.toFixed(0)} px`);
  }

  // Play is right under the picture, and one screen shows both.
  const stage = document.querySelector('.replay-stage')?.getBoundingClientRect();
  const play = document.querySelector('.replay-play')?.getBoundingClientRect();
  if (stage !== undefined && (play.top - stage.bottom > 30 || play.top < stage.bottom || play.bottom - stage.top > innerHeight)) {
    faults.push(`Play begins ${(play.top - stage.bottom).toFixed(0)} px below the picture`);
  }

  // The texts of a chart are whole and cover no other texts in the same direction. Texts of which a
  // legend shows a part, page by page, have a clip path.
  for (const plot of document.querySelectorAll('.plot, main > section svg')) {
    const figure = plot.closest('.card')?.dataset.figure ?? 'the sheet';
    const frame = plot.getBoundingClientRect();
    const texts = Array.from(plot.querySelectorAll('text'))
      .filter((text) => text.textContent.trim() !== '' && text.closest('[clip-path]') === null)
      .map((text) => {
        const { a, b, c, d, e, f } = text.getScreenCTM();
        const { x, y, width, height } = text.getBBox();
        const [u, v] = [x + width / 2, y + height / 2];
        return {
          words: text.textContent.trim(),
          box: text.getBoundingClientRect(),
          angle: Math.atan2(b, a),
          centre: [a * u + c * v + e, b * u + d * v + f],
          width,
          height,
        };
      });
    for (const { words, box, angle } of texts) {
      const over = Math.max(frame.left - box.left, box.right - frame.right, frame.top - box.top, box.bottom - frame.bottom);
      if (over > 2) {
        faults.push(`"${words}" in ${figure} is cut by ${over.toFixed(0)} px`);
      }
      // Only the name of an ordinate stands upright, and the many axes of a design have no room for level names.
      const is_level = Math.abs(angle) < 0.01 || Math.abs(angle + Math.PI / 2) < 0.01;
      if (!is_level && !figure.startsWith('parallel')) {
        faults.push(`"${words}" in ${figure} is tilted`);
      }
      if (/(\.\.\.|…)$/.test(words)) {
        faults.push(`"${words}" in ${figure} is shortened`);
      }
    }
    texts.forEach((a, i) => {
      const [cos, sin] = [Math.cos(a.angle), Math.sin(a.angle)];
      for (const b of texts.slice(0, i).filter((one) => Math.abs(one.angle - a.angle) < 0.01)) {
        const [x, y] = [b.centre[0] - a.centre[0], b.centre[1] - a.centre[1]];
        const along = (a.width + b.width) / 2 - Math.abs(x * cos + y * sin);
        const across = (a.height + b.height) / 2 - Math.abs(y * cos - x * sin);
        // The box of a line is higher than its letters.
        if (along > 2 && across > 0.3 * Math.min(a.height, b.height)) {
          faults.push(`"${a.words}" and "${b.words}" in ${figure} overlap by ${along.toFixed(0)} x ${across.toFixed(0)} px`);
        }
      }
    });
    // The curves of figures with one panel have most of the width.
    if (/^(convergence|runtime-ecdf|data-profile|performance-profile|fitness|joint-)/.test(figure)) {
      const lines = Array.from(plot.querySelectorAll('svg path[fill="none"], svg path[fill="transparent"]'));
      const widest = Math.max(...lines.map((line) => line.getBoundingClientRect().width));
      if (widest < 0.6 * frame.width) {
        faults.push(`the curves of ${figure} have ${widest.toFixed(0)} px of ${frame.width.toFixed(0)} px`);
      }
    }
  }

  // No line breaks a short unit, such as "(N m)".
  for (const button of document.querySelectorAll('th button')) {
    const text = button.firstChild;
    const unit = text.textContent.match(/\(.{1,8}\)$/);
    if (unit !== null && is_visible(button)) {
      const range = document.createRange();
      range.setStart(text, unit.index);
      range.setEnd(text, text.length);
      if (new Set(Array.from(range.getClientRects(), (rect) => Math.round(rect.bottom))).size > 1) {
        faults.push(`the unit of ${name(button)} is broken`);
      }
    }
  }

  // A label has at most one line per word.
  for (const label of document.querySelectorAll('h1, h3, dt, th, button, label > span, .thesis, .subtitle')) {
    if (!is_visible(label)) {
      continue;
    }
    const lines = new Set();
    const texts = document.createTreeWalker(label, NodeFilter.SHOW_TEXT);
    const range = document.createRange();
    while (texts.nextNode()) {
      range.selectNodeContents(texts.currentNode);
      Array.from(range.getClientRects()).forEach((rect) => lines.add(Math.round(rect.bottom)));
    }
    const words = label.textContent.split(/[\s/_-]+|(?<=[a-z])(?=[A-Z(])/).filter((word) => word !== '').length;
    if (lines.size > Math.max(1, words)) {
      faults.push(`${name(label)} has ${words} words in ${lines.size} lines`);
    }
  }
  return faults;
}

// Each tab has two widths in one theme and two in the other. The next tab has the themes the other way round, and so
// has the first tab of every second page. Each change of the theme draws all charts of the tab.
async function check_page(name, address = join(kFolder, `${name}.html`)) {
  const { page, expect_no_faults } = await open_page(browser, address);
  const toggle = () => page.evaluate(() => document.querySelector('.theme').click());
  if (kReports.indexOf(name) % 2 === 1) {
    await toggle();
  }
  const found = [];
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    for (const widths of kWidths) {
      if (widths !== kWidths[0]) {
        await toggle();
      }
      for (const width of widths) {
        await page.setViewportSize({ width, height: kHeight });
        await settle(page);
        const where = `${name}, ${tab}, ${width} px, ${await page.getAttribute('html', 'data-theme')}: `;
        found.push(...(await page.evaluate(find_faults)).map((fault) => where + fault));
      }
    }
  }
  expect_no_faults();
  await page.close();
  assert.ok(found.length === 0, `${found.length} faults:\n${found.slice(0, 40).join('\n')}`);
}

for (const name of kReports) {
  test(`the layout of the page "${name}" fits every width`, () => check_page(name));
}

test('the layout of the page of a study under way fits every width', async () => {
  const { address, stop } = await start_watch('watched-for-layout');
  await check_page('watch', address).finally(stop);
});

test('the layout of a data sheet fits every width', async () => {
  const page = await browser.context.newPage();
  await page.goto(pathToFileURL(make_datasheet('datasheet-for-layout')).href);
  const found = [];
  for (const width of kWidths.flat()) {
    await page.setViewportSize({ width, height: kHeight });
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme });
      found.push(...(await page.evaluate(find_faults)).map((fault) => `${width} px, ${colorScheme}: ${fault}`));
    }
    // A cell that is cut shows its text to the pointer.
    const cut = await page.$$eval('th, td, dd', (all) =>
      all
        .filter((one) => (one.scrollWidth > one.clientWidth || one.scrollHeight > one.clientHeight + 1) && one.title === '')
        .map((one) => one.textContent),
    );
    found.push(...cut.map((text) => `${width} px: "${text}" is cut`));
  }
  await page.close();
  assert.deepEqual(found, []);
});

test('keys scroll a cut table, and at its end the shadow is on the other side', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.setViewportSize({ width: 390, height: kHeight });
  await settle(page);
  const box = page.getByRole('region', { name: 'Result' });
  const list_shadows = () =>
    box.evaluate((one) => Array.from(one.parentElement.querySelectorAll('.cut:not([hidden])'), (cut) => cut.className));
  assert.deepEqual(await list_shadows(), ['cut cut-right']);
  await box.focus();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => document.activeElement.scrollLeft > 2);
  await settle(page);
  assert.ok((await list_shadows()).includes('cut cut-left'));
  await box.evaluate((one) => (one.scrollLeft = one.scrollWidth));
  await settle(page);
  assert.deepEqual(await list_shadows(), ['cut cut-left']);
  expect_no_faults();
  await page.close();
});

test('the dialog with the numbers of a figure shows all of its parts on a narrow screen', async () => {
  const { page, expect_no_faults } = await open_page(browser, join(kFolder, 'run.html'));
  await page.setViewportSize({ width: 390, height: kHeight });
  await open_tab(page, 'response');
  await page.locator('[data-figure=distance-response]').getByRole('button', { name: 'Table' }).click();
  await settle(page);
  const dialog = await page.locator('dialog').boundingBox();
  const hint = await page.locator('dialog .cut-hint').boundingBox();
  assert.ok(
    hint.y + hint.height <= dialog.y + dialog.height,
    `the sentence ends at ${hint.y + hint.height}, the dialog at ${dialog.y + dialog.height}`,
  );
  expect_no_faults();
  await page.close();
});
