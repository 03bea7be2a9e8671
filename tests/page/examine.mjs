// What the tests look for on a page: faults of the layout, violations of axe-core's rules, silent charts, empty cards,
// an invisible focus and motion.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { draw_frames, list_tabs, open_tab } from './browser.mjs';

const kAxe = readFileSync(createRequire(new URL('../../web/package.json', import.meta.url)).resolve('axe-core/axe.min.js'), 'utf8');
const kHeight = 844; // pixels, of a telephone's screen

// Charts draw again in the frame after a change of their size.
export async function settle(page) {
  await page.waitForFunction(() =>
    Array.from(document.querySelectorAll('.plot')).every(
      (plot) => plot.querySelector('svg')?.getAttribute('width') === String(plot.clientWidth),
    ),
  );
  await draw_frames(page, 2);
}

// Opens each tab of the page at each of the widths. The next tab has the widths in reverse order, so that a change of
// either draws the charts once. Calls `look` with the name of the tab and the width when the charts are drawn. A page in
// two `themes` has the first one at the first half of the widths.
export async function go_through(page, widths, themes, look) {
  const stops = widths.map((width, i) => ({ width, theme: themes[Math.floor((i * themes.length) / widths.length)] }));
  for (const tab of await list_tabs(page)) {
    await open_tab(page, tab);
    for (const { width, theme } of stops) {
      await page.setViewportSize({ width, height: kHeight });
      if ((await page.getAttribute('html', 'data-theme')) !== theme) {
        await page.evaluate(() => document.querySelector('.theme').click());
      }
      await settle(page);
      await look(tab, width, theme);
    }
    stops.reverse();
  }
}

// Returns one sentence per fault of the cards of the open tab: each card has a name of its own, each chart is drawn, each
// table has a head, and nothing is wider than its card. Adds the names with their tab to `names`, which has those of the
// tabs before.
export async function find_faulty_cards(page, tab, names) {
  const cards = await page.$$eval('.card', (all) =>
    all.map((card) => ({
      id: card.dataset.figure,
      plot: card.querySelector('.plot') !== null,
      shapes: card.querySelectorAll('.plot svg path, .plot svg text').length,
      table: card.querySelector('table') !== null,
      headings: card.querySelectorAll('th').length,
      wide: card.scrollWidth > card.clientWidth + 1,
    })),
  );
  const faults = cards.length > 0 ? [] : ['the tab is empty'];
  for (const { id, plot, shapes, table, headings, wide } of cards) {
    const found = {
      'a card has no name': !id,
      [`${id} shows no chart`]: plot && shapes <= 5,
      [`table ${id} has no head`]: table && headings === 0,
      [`${id} is wider than its card`]: wide,
      [`two cards are called ${id}`]: (names.get(id) ?? tab) !== tab || cards.filter((card) => card.id === id).length > 1,
    };
    faults.push(...Object.keys(found).filter((fault) => found[fault]));
    names.set(id, tab);
  }
  if (await page.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth + 1)) {
    faults.push('the tab scrolls sideways');
  }
  return faults;
}

// Returns one sentence per fault of the layout that is now on the screen. Runs in the page.
export function find_layout_faults() {
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

// Runs axe-core in the page, on what is now on the screen, and returns its violations. Before, the function takes out
// what cannot add a finding, and puts it back after. This is the drawing of a chart: axe-core has no rule for its
// parts, and it cannot tell the ground of a text in an SVG. It is also each row of a table that repeats an earlier one:
// the same elements with the same attributes and computed colours, and texts in the same places.
async function run_axe(options) {
  const undo = [];
  const put = (one, other) => {
    one.replaceWith(other);
    undo.push(() => other.replaceWith(one));
  };
  document.querySelectorAll('.plot svg').forEach((svg) => put(svg, document.createComment('svg')));

  const describe = (element) => {
    const { color, backgroundColor, backgroundImage, fontSize, fontWeight, opacity, visibility, display } = getComputedStyle(element);
    const attributes = Array.from(element.attributes, ({ name, value }) => `${name}=${name === 'title' ? value.trim() !== '' : value}`);
    const texts = Array.from(element.childNodes, (node) =>
      node.nodeType === Node.ELEMENT_NODE ? describe(node) : node.textContent.trim().slice(0, 2).length,
    );
    return [
      element.tagName,
      attributes,
      color,
      backgroundColor,
      backgroundImage,
      fontSize,
      fontWeight,
      opacity,
      visibility,
      display,
      texts,
    ];
  };
  for (const body of document.querySelectorAll('tbody')) {
    const known = new Set();
    const repeated = Array.from(body.rows).filter((row) => {
      const description = JSON.stringify(describe(row));
      return known.size === known.add(description).size;
    });
    if (repeated.length > 0) {
      // The box of the table is cut as before.
      const table = body.closest('table');
      const { minWidth } = table.style;
      const heights = repeated.map((row) => row.offsetHeight);
      table.style.minWidth = `${table.offsetWidth}px`;
      undo.push(() => (table.style.minWidth = minWidth));
      repeated.forEach((row, i) => {
        const gap = document.createElement('tr');
        gap.style.height = `${heights[i]}px`;
        put(row, gap);
      });
    }
  }

  const { violations } = await globalThis.axe.run(document, { resultTypes: ['violations'], ...options });
  undo.reverse().forEach((step) => step());
  return violations.map(({ impact, id, help, nodes }) => ({ impact, id, help, nodes: nodes.slice(0, 1), count: nodes.length }));
}

// Returns one sentence per violation that axe-core finds in what is now on the screen. Playwright evaluates its
// source, so that the pages' content security policy stays as it is. Axe-core names the places of its findings in a
// second run, because it would name the place of each element that it looks at.
export async function find_violations(page) {
  if (!(await page.evaluate(() => 'axe' in globalThis))) {
    await page.evaluate(kAxe);
  }
  const found = await page.evaluate(run_axe, { selectors: false });
  const named = found.length === 0 ? [] : await page.evaluate(run_axe, {});
  return (named.length < found.length ? found : named).map(({ impact, id, help, nodes: [{ target, html, any }], count }) => {
    return `${impact}: ${id}: ${help}; ${count} of ${target?.join(' ')}: ${html.slice(0, 160)} ${any[0]?.message ?? ''}`;
  });
}

// Returns one sentence per chart that says its title alone, or nothing of what it shows.
export async function find_silent_charts(page) {
  const charts = await page.$$eval('.card .plot', (plots) =>
    plots.map((plot) => {
      const card = plot.closest('.card');
      return {
        id: card.dataset.figure,
        title: card.querySelector('h3').textContent,
        role: plot.getAttribute('role'),
        label: plot.ariaLabel ?? '',
      };
    }),
  );
  return charts
    .filter(({ title, role, label }) => {
      const seen = label.slice(title.length + 2);
      return role !== 'img' || !label.startsWith(title + '. ') || seen.split(' ').length < 6 || !/\d/.test(seen);
    })
    .map(({ id, label }) => `the chart ${id} says "${label}"`);
}

// Presses Tab until the focus leaves the page or comes around. Returns what had the focus, and complains about each
// element that does not show it.
export async function walk(page) {
  const stops = [];
  for (let i = 0; i < 400; ++i) {
    await page.keyboard.press('Tab');
    const stop = await page.evaluate(() => {
      const element = document.activeElement;
      if (element === document.body || element.dataset.visited) {
        return null;
      }
      element.dataset.visited = 'yes';
      const { outlineStyle, outlineWidth } = getComputedStyle(element);
      const { width, height, right } = element.getBoundingClientRect();
      return {
        name: `${element.tagName.toLowerCase()} ${element.id || element.className} "${(element.ariaLabel ?? element.textContent).trim().slice(0, 40)}"`,
        is_shown: outlineStyle !== 'none' && parseFloat(outlineWidth) >= 1 && width > 0 && height > 0 && right > 0,
      };
    });
    if (stop === null) {
      break;
    }
    stops.push(stop);
  }
  assert.deepEqual(
    stops.filter(({ is_shown }) => !is_shown).map(({ name }) => name),
    [],
    'the focus is not visible',
  );
  return stops.map(({ name }) => name);
}

// Returns the elements that move or scroll by themselves.
export function find_motion() {
  const is_still = (element, pseudo) => {
    const style = getComputedStyle(element, pseudo);
    const moves = style.animationName !== 'none' || style.transitionDuration.split(', ').some((time) => time !== '0s');
    return !moves && style.scrollBehavior === 'auto';
  };
  const found = Array.from(document.querySelectorAll('*')).filter(
    (one) => ![null, '::before', '::after'].every((part) => is_still(one, part)),
  );
  return found
    .map((one) => `${one.tagName} ${one.getAttribute('class')} ${one.getAttribute('style')}`)
    .concat(document.getAnimations().map(String));
}
