// Draws every figure of a page without a browser, to look at them while working on them:
//
//   node preview.mjs PAGE.json FOLDER [WIDTH HEIGHT]
//
// writes FOLDER/ID-light.svg and FOLDER/ID-dark.svg of each figure, FOLDER/choices/ID-CHOICE-VALUE.svg of
// its other choices, and FOLDER/index-light.html, FOLDER/index-dark.html with all of them and their captions.
// PAGE.json is what `armwright report --json` feeds its page with; "run" or "reproduction" stand for the
// made-up pages of the tests. WIDTH and HEIGHT are in pixels, 640 and each figure's own if not given.
import { build } from 'esbuild';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const [source, folder, width = '640', height = ''] = process.argv.slice(2);
if (!source || !folder) {
  console.error('usage: node preview.mjs PAGE.json|run|reproduction FOLDER [WIDTH HEIGHT]');
  process.exit(2);
}
const here = dirname(fileURLToPath(import.meta.url));
const bundle = await build({
  stdin: {
    contents: `
      export { echarts } from './src/charts/echarts';
      export { kDark, kLight } from './src/charts/look';
      export { make_page } from './src/figures/page';
      export { make_reproduction_data, make_run_data } from './tests/fixtures/pages';`,
    resolveDir: here,
    loader: 'ts',
  },
  bundle: true,
  format: 'esm',
  write: false,
  logLevel: 'error',
});
const { echarts, kDark, kLight, make_page, make_reproduction_data, make_run_data } = await import(
  `data:text/javascript;base64,${Buffer.from(bundle.outputFiles[0].contents).toString('base64')}`
);

const made_up = { run: make_run_data, reproduction: make_reproduction_data };
const data = made_up[source] ? made_up[source]() : JSON.parse(readFileSync(source, 'utf8'));
const page = make_page(data);

function draw(figure, look, picked) {
  const chart = echarts.init(null, null, {
    renderer: 'svg',
    ssr: true,
    width: figure.width === 'full' && !process.argv[4] ? 1000 : Number(width),
    height: Number(height) || figure.height || 340,
  });
  chart.setOption(figure.draw(look, picked));
  const svg = chart.renderToSVGString();
  chart.dispose();
  return svg;
}

const get_initial = (figure) => Object.fromEntries((figure.choices ?? []).map((choice) => [choice.id, choice.initial]));
const escape = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
const as_file = (text) => text.replace(/[^A-Za-z0-9._-]+/g, '_').slice(0, 80);

mkdirSync(join(folder, 'choices'), { recursive: true });
for (const look of [kLight, kDark]) {
  let html = `<!doctype html><meta charset="utf-8"><body style="background:${look.background};color:${look.text};font-family:sans-serif;margin:12px">`;
  for (const tab of page.tabs) {
    html += `<h2>${escape(tab.title)}</h2><div style="display:flex;flex-wrap:wrap;gap:16px">`;
    for (const item of tab.items) {
      if (item.kind !== 'figure') {
        continue;
      }
      const name = `${as_file(item.id)}-${look.theme}.svg`;
      writeFileSync(join(folder, name), draw(item, look, get_initial(item)));
      html += `<div style="max-width:1000px"><b>${escape(`${item.title} ${item.thesis ?? ''}`)}</b><br><img src="${name}" style="border:1px solid ${look.grid}">`;
      html += `<p style="max-width:640px;font-size:12px">${escape(item.caption)}</p></div>`;
      if (look === kLight) {
        for (const choice of item.choices ?? []) {
          for (const option of choice.options) {
            const svg = draw(item, look, { ...get_initial(item), [choice.id]: option.value });
            writeFileSync(join(folder, 'choices', `${as_file(`${item.id}-${choice.id}-${option.value}`)}.svg`), svg);
          }
        }
      }
    }
    html += '</div>';
  }
  writeFileSync(join(folder, `index-${look.theme}.html`), html);
}
