// The contrast of the colours of charts, pages and the site in both themes, as WCAG 2 asks for it: 4.5 for text, 3 for
// curves and symbols. https://www.w3.org/TR/WCAG22/#dfn-contrast-ratio has the equations.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { load } from './load.mjs';

const { get_readable, kDark, kLight, mix } = await load(`
  export { get_readable, mix } from './src/charts/fills';
  export { kDark, kLight } from './src/charts/look';
`);

function find_luminance(color) {
  const parts = color.startsWith('#') ? [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16)) : color.match(/\d+/g).map(Number);
  const [red, green, blue] = parts
    .map((part) => part / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function find_contrast(a, b) {
  const [low, high] = [find_luminance(a), find_luminance(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

function expect_contrast(what, color, ground, least) {
  const contrast = find_contrast(color, ground);
  assert.ok(contrast >= least, `${what}: ${color} on ${ground} has a contrast of ${contrast.toFixed(2)}, and ${least} is the least`);
}

// Returns the variables in the first block with this selector.
function read_variables(file, selector) {
  const style = readFileSync(new URL(file, import.meta.url), 'utf8');
  const begin = style.indexOf(`${selector} {`);
  assert.ok(begin >= 0, `${file} has no ${selector}`);
  return Object.fromEntries(
    [...style.slice(begin, style.indexOf('}', begin)).matchAll(/--([\w-]+): ([^;]+);/g)].map(([, name, value]) => [name, value]),
  );
}

test('the equation gives the known values', () => {
  assert.equal(find_contrast('#000000', '#ffffff').toFixed(2), '21.00');
  assert.equal(find_contrast('#767676', '#ffffff').toFixed(2), '4.54');
});

for (const look of [kLight, kDark]) {
  test(`a ${look.theme} chart can be read`, () => {
    look.series.concat(look.accent, look.bad).forEach((color, i) => expect_contrast(`curve ${i}`, color, look.background, 3));
    for (const name of ['text', 'muted']) {
      expect_contrast(name, look[name], look.background, 4.5);
    }
    // The fills of grids of ranks and pairs.
    for (const color of [look.accent, look.bad, ...look.series]) {
      for (let share = 0; share <= 1; share += 0.05) {
        const fill = mix(look.background, color, share);
        expect_contrast(`text on a share of ${share.toFixed(2)}`, get_readable(fill), fill, 4.5);
      }
    }
  });
}

for (const selector of [':root', ":root[data-theme='dark']"]) {
  test(`the texts of a page can be read: ${selector}`, () => {
    const colors = read_variables('../src/app/page.css', selector);
    for (const name of ['text', 'muted', 'accent', 'good', 'near', 'bad']) {
      for (const ground of ['background', 'card', 'page']) {
        expect_contrast(name, colors[name], colors[ground], 4.5);
      }
    }
  });
}

test('the charts and the page around them have one ground', () => {
  assert.equal(read_variables('../src/app/page.css', ':root').card, kLight.background);
  assert.equal(read_variables('../src/app/page.css', ":root[data-theme='dark']").card, kDark.background);
});

test('the texts of the site can be read in both themes', () => {
  const pairs = Object.entries(read_variables('../site/site.css', ':root')).map(([name, value]) => [name, value.match(/#[0-9a-f]{6}/g)]);
  const colors = Object.fromEntries(pairs);
  for (const theme of [0, 1]) {
    for (const name of ['text', 'muted', 'accent', 'keyword', 'string', 'number', 'comment', 'name']) {
      for (const ground of ['background', 'raised', 'code']) {
        expect_contrast(`${name} in theme ${theme}`, colors[name][theme], colors[ground][theme], 4.5);
      }
    }
    // The chosen page in the list of pages, and the results of the search.
    for (const name of ['text', 'muted', 'accent']) {
      expect_contrast(`${name} in theme ${theme}`, colors[name][theme], colors['accent-soft'][theme], 4.5);
    }
  }
});
