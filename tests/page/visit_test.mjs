// Every tab of every page is visited once at the widths of a telephone, a tablet and two screens, in both themes; the quick
// check visits two pages at all of them, and the others as on a telephone and on one screen (../long-tests.md). At each width nothing leaves its place and every chart is drawn. On the telephone and on a screen, in different themes, axe-core
// finds nothing, and on the screen it also looks at the dialog of the first figure. Each chart has a sentence about what
// it shows, each tab has its figures, and a page calls each design by one name.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { list_tabs, open_browser, open_page } from './browser.mjs';
import { find_faulty_cards, find_layout_faults, find_silent_charts, find_violations, go_through } from './examine.mjs';
import { kFolder } from './make_pages.mjs';
import { start_watch } from './pages.mjs';

const kWidths = [390, 768, 1280, 1920];
const kWithAxe = [390, 1280];
const kAtAllWidths = ['run', 'study']; // in the quick check
const kThemes = ['light', 'dark'];

const kOfDesigns = ['joint-angles', 'joint-errors', 'joint-torques', 'distance-response', 'momentary-error', 'test-errors'];

// The figures and tables that a page must have, and some that it must not have.
const kPages = {
  run: {
    has: [
      ...kOfDesigns,
      ...['fitness', 'variables', 'signals-distance', 'signals-speed', 'signals-acceleration', 'speed-reduction', 'test-case'],
      ...['speed-sweep', 'design-table'],
    ],
  },
  study: {
    has: [
      ...['headline', 'standing', 'verdict', 'ranks', 'pooled-ecdf', 'data-profile'],
      ...['convergence', 'runtime-ecdf', 'values', 'pairs', 'parallel', 'cost-quality'].map((name) => `${name}-q1-complex`),
    ],
  },
  front: { has: ['fitness', 'front', 'joint-torques'] },
  reproduction: { has: ['headline', 'agreement'] },
  function: { has: ['fitness'], lacks: ['front', 'joint-torques'] },
  own: { has: ['fitness', 'variables-table', 'limits-table', 'winner-record', 'winner-files'], lacks: ['joint-torques'] },
  identification: {
    has: ['doubts', 'fit-table', 'replay', 'efforts', 'parameters-table', 'intervals', 'fitness'],
    tabs: ['overview', 'motion', 'parameters', 'search'], // none of a design
  },
  comparison: {
    has: ['health-a', 'health-b', 'differences', 'courses', 'test-errors', 'case-pairs', 'distance-response', 'momentary-error'],
  },
  'study-comparison': { has: ['compared-grid', 'convergence', 'values'] },
};

// The figures of the thesis that show results; its others are drawings and screen shots.
const kThesis = [
  ...['5.5', '5.6', '5.7', '5.8', '5.9', '5.10', '5.11', '5.12', '6.4', '6.5', '6.6', '6.7', '6.8', '6.9'],
  ...['6.10', '6.11', '6.12', '6.13', '6.15', '6.16'],
];

// The ids that the data use inside, and older names.
const kOldNames = /^(base|start design|where the problem starts|thesis, Table A\.\d+)$/;

let browser;
before(async () => {
  browser = await open_browser({ reducedMotion: 'reduce' });
});
after(() => browser.close());

// Returns the texts of tables and charts, and what stands beside the titles of figures of the thesis. Runs in the page.
function list_texts() {
  const read = (selector) => Array.from(document.querySelectorAll(selector), (one) => one.textContent);
  return { texts: read('main td, main th, main svg text'), notes: read('.thesis') };
}

// Returns the faults, the names of all figures and tables, and the figures of the thesis to which some of them belong.
async function visit(page, name, themes) {
  const widths = process.env.ARMWRIGHT_LONG_TESTS === undefined && !kAtAllWidths.includes(name) ? kWithAxe : kWidths;
  const faults = [];
  const names = new Map();
  const thesis = new Set();
  await go_through(page, widths, themes, async (tab, width, theme) => {
    const add = (found, place = '') => faults.push(...found.map((fault) => `${name}, ${tab}, ${width} px, ${theme}${place}: ${fault}`));
    add(await page.evaluate(find_layout_faults));
    add(await find_faulty_cards(page, tab, names));
    const { texts, notes } = await page.evaluate(list_texts);
    add(texts.filter((text) => kOldNames.test(text)).map((text) => `"${text}" is no name of a design`));
    notes.flatMap((note) => note.match(/\d+\.\d+/g) ?? []).forEach((number) => thesis.add(number));
    if (!kWithAxe.includes(width)) {
      return;
    }
    add(await find_violations(page));
    add(await find_silent_charts(page));
    const tables = page.locator('figure .buttons button:has-text("Table")');
    if (width === kWithAxe[1] && (await tables.count()) > 0) {
      await tables.first().click();
      add(await find_violations(page), ', dialog');
      await page.click('.close-dialog');
    }
  });
  return { faults, names: [...names.keys()], thesis };
}

function expect_none(faults) {
  assert.ok(faults.length === 0, `${faults.length} faults:\n${faults.slice(0, 40).join('\n')}`);
}

// Every second page has the themes the other way round.
Object.entries(kPages).forEach(([name, { has, lacks = [], tabs }], i) => {
  test(`every tab of the page "${name}" is complete and fits every width, and axe-core finds nothing on it`, async () => {
    const { page, expect_no_faults } = await open_page(browser, join(kFolder, `${name}.html`));
    if (tabs !== undefined) {
      assert.deepEqual(await list_tabs(page), tabs);
    }
    const { faults, names, thesis } = await visit(page, name, i % 2 === 0 ? kThemes : kThemes.slice().reverse());
    expect_none(faults);
    const missing = has.filter((one) => !names.includes(one));
    assert.deepEqual(missing, [], `these are missing; there are ${names.join(', ')}`);
    assert.deepEqual(
      lacks.filter((one) => names.includes(one)),
      [],
    );
    if (name === 'reproduction') {
      const lost = kThesis.filter((one) => !thesis.has(one));
      assert.deepEqual(lost, [], `figures of the thesis without a counterpart; there are ${[...thesis].join(', ')}`);
    }
    expect_no_faults();
    await page.close();
  });
});

test('every tab of the page of a study under way is complete and fits every width, and axe-core finds nothing on it', async (t) => {
  const { address, stop } = await start_watch('watched-for-visit');
  t.after(stop);
  const { page, expect_no_faults } = await open_page(browser, address);
  const { faults } = await visit(page, 'watch', kThemes);
  expect_none(faults);
  expect_no_faults();
  await page.close();
});
