// Opens pages as a reader would: in Debian's Chromium, from disk. Whatever the page writes to the
// console as an error, throws, or asks of the network is remembered and fails the test at its end.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const { chromium } = createRequire(new URL('../../web/package.json', import.meta.url))('playwright-core');

const kProgram = process.env.CHROMIUM ?? '/usr/bin/chromium';
const kFlags = [
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-quic',
  '--disable-sync',
  '--no-first-run',
  '--no-sandbox',
];

// `options` are Playwright's for the context: with reducedMotion no animation takes processor time.
export async function open_browser(options = {}) {
  assert.ok(existsSync(kProgram), `${kProgram} is missing: install the Debian package chromium (scripts/setup --tests does)`);
  const profile = mkdtempSync(join(tmpdir(), 'armwright-chromium-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: kProgram,
    headless: true,
    args: kFlags,
    viewport: { width: 1280, height: 900 },
    colorScheme: 'light',
    acceptDownloads: true,
    ...options,
  });
  context.setDefaultTimeout(120_000); // for what takes a second on a quiet machine
  return {
    context,
    async close() {
      await context.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

// A page and what went wrong in it so far.
export async function open_page(browser, address) {
  const page = await browser.context.newPage();
  const faults = [];
  page.on('console', (message) => {
    // Chromium's own remark on how it shows a canvas without a graphics card.
    const of_driver = /GL Driver Message .*GPU stall due to ReadPixels/.test(message.text());
    if (message.type() === 'error' || (message.type() === 'warning' && !of_driver)) {
      faults.push(`${message.type()}: ${message.text()}`);
    }
  });
  page.on('pageerror', (error) => faults.push(`thrown: ${error.message}`));
  page.on('dialog', (dialog) => {
    faults.push(`dialog: ${dialog.message()}`);
    void dialog.dismiss();
  });
  const url = address.includes('://') ? address : pathToFileURL(address).href;
  page.on('request', (request) => {
    const asked = request.url();
    const own = asked === url || asked.startsWith('blob:') || asked.startsWith('data:');
    if (!own && !(url.startsWith('http') && asked.startsWith(new URL(url).origin))) {
      faults.push(`network: ${asked}`);
    }
  });
  await page.goto(url);
  await page.waitForSelector('[role=tab]');
  return {
    page,
    expect_no_faults() {
      assert.deepEqual(faults, []);
    },
  };
}

export async function list_tabs(page) {
  return page.$$eval('[role=tab]', (tabs) => tabs.map((tab) => tab.dataset.tab));
}

export async function open_tab(page, id) {
  await page.click(`[role=tab][data-tab="${id}"]`);
  await page.waitForSelector(`[role=tab][data-tab="${id}"][aria-selected=true]`);
}

// Returns when the page has drawn so many frames.
export async function draw_frames(page, count) {
  await page.evaluate(async (frames) => {
    for (let i = 0; i < frames; ++i) {
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
  }, count);
}

// The card of a figure or table, its chart drawn.
export async function find_figure(page, id) {
  const card = page.locator(`[data-figure="${id}"]`);
  await card.scrollIntoViewIfNeeded();
  return card;
}

// Clicks in a figure's chart at these shares of its width and height, as soon as it is drawn and its place no longer changes. Returns the place.
export async function click_plot(card, across, down) {
  const plot = card.locator('.plot');
  await plot.locator('svg path').first().waitFor({ state: 'attached' });
  const { width, height } = await plot.boundingBox();
  await plot.click({ position: { x: width * across, y: height * down } });
  return plot.boundingBox();
}

// Returns the centres of the small shapes of a figure's chart, such as its points, in pixels of the screen.
export async function list_points(card) {
  return card.locator('.plot svg path').evaluateAll((shapes) =>
    shapes
      .map((shape) => shape.getBoundingClientRect())
      .filter(({ width, height }) => Math.min(width, height) > 1 && Math.max(width, height) < 20)
      .map(({ x, y, width, height }) => [x + width / 2, y + height / 2]),
  );
}
